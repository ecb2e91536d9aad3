// SPDX-License-Identifier: Apache-2.0
// Random numbers with coordinates: (seed, frame, pixel, sample, set) in, two numbers out; there is no
// generator state. Each set of a pixel half is a (0,2)-sequence in its sample index, scrambled and shuffled
// on its own (Burley 2020, "Practical Hash-based Owen Scrambling"; Laine and Karras 2011).
#pragma once

#include <array>
#include <cstdint>

#include "worker/render/wide.h"

namespace tessera::tracer {

// Stafford's variant 13 of the 64-bit finaliser of MurmurHash3.
inline std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

inline std::uint32_t reversed_bits(std::uint32_t x) {
  x = __builtin_bswap32(x);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  return ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
}

// Owen scrambling of a number whose most significant digit is its lowest bit: a bit is flipped by a hash of
// the bits below it only. Constants by Vegdahl 2021, "Building a Better LK Hash".
inline std::uint32_t owen_scrambled_reversed(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  return x ^ (x * 0x53a22864u);
}

// The second Sobol dimension of `index`, bits reversed. Its matrix is Pascal's triangle modulo 2; by Lucas'
// theorem C(k, j) is odd where j's bits are among k's, so the product is a superset sum over bit positions.
inline std::uint32_t sobol_second_reversed(std::uint32_t index) {
  index ^= (index >> 1) & 0x55555555u;
  index ^= (index >> 2) & 0x33333333u;
  index ^= (index >> 4) & 0x0f0f0f0fu;
  index ^= (index >> 8) & 0x00ff00ffu;
  return index ^ (index >> 16);
}

inline float unit_float(std::uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }

// What identifies the randomness of one half of a pixel: even samples are half A, odd ones half B.
inline std::uint64_t half_key(std::uint64_t seed, int frame, int x, int y, int half) {
  const auto word = [](int v) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(v)); };
  const std::uint64_t a = mixed(seed + 0x9e3779b97f4a7c15u);
  const std::uint64_t b = mixed(a ^ (word(frame) << 1 | word(half)));
  return mixed(b ^ (word(y) << 32 | word(x)));
}

// The position of a sample in its half's sequence, bits reversed.
inline std::uint32_t half_index_reversed(int sample) {
  return reversed_bits(static_cast<std::uint32_t>(sample) >> 1);
}

// Two numbers in [0, 1); sets are independent of one another. `key` is that of half `sample & 1`.
inline Vec2 random_pair(std::uint64_t key, std::uint32_t index_reversed, std::uint32_t set) {
  const std::uint64_t seeds = mixed(key + (set + 1u) * 0x9e3779b97f4a7c15u);
  const auto shuffle = static_cast<std::uint32_t>(seeds);
  const auto first = static_cast<std::uint32_t>(seeds >> 32);
  const auto second = static_cast<std::uint32_t>((seeds * 0xd1342543de82ef95u) >> 32);
  const std::uint32_t index = reversed_bits(owen_scrambled_reversed(index_reversed, shuffle));
  return {unit_float(reversed_bits(owen_scrambled_reversed(index, first))),
          unit_float(reversed_bits(owen_scrambled_reversed(sobol_second_reversed(index), second)))};
}

// Pairs for the pixels of a block side by side.
template <std::size_t N>
struct RandomPairs {
  alignas(64) std::array<float, N> x, y;

  void draw(const std::array<std::uint64_t, N>& keys, std::uint32_t index_reversed, std::uint32_t set) {
    for (std::size_t i = 0; i < N; ++i) {
      const Vec2 pair = random_pair(keys[i], index_reversed, set);
      x[i] = pair.x;
      y[i] = pair.y;
    }
  }
  // The first of each pair only.
  void draw_first(const std::array<std::uint64_t, N>& keys, std::uint32_t index_reversed, std::uint32_t set) {
    for (std::size_t i = 0; i < N; ++i) x[i] = random_pair(keys[i], index_reversed, set).x;
  }
  Vec2 operator[](std::size_t i) const { return {x[i], y[i]}; }
  Wide2 all() const { return {load(x.data()), load(y.data())}; }
};

}  // namespace tessera::tracer
