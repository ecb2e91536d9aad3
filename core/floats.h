// SPDX-License-Identifier: Apache-2.0
// Vectors of floats for planes. New elements are unset until written: planes are written whole, and setting
// gigabytes to zero first is a second pass over them. Large ones lie on large pages.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace tessera {

// Memory for a plane or many, from 8 MiB on in large pages (and aligned to them) where the system has them to give: who
// walks dozens of planes at once is on a page of its own in each otherwise, and a first touch of each small page costs
// more than what is done with it. Throws std::bad_alloc.
void* plane_memory(std::size_t bytes);
void free_plane_memory(void* memory) noexcept;

template <class T>
struct Unset {
  using value_type = T;
  Unset() = default;
  template <class U>
  Unset(const Unset<U>&) noexcept {}
  T* allocate(std::size_t n) { return static_cast<T*>(plane_memory(n * sizeof(T))); }
  void deallocate(T* p, std::size_t) noexcept { free_plane_memory(p); }
  template <class U>
  void construct(U* p) noexcept {
    ::new (static_cast<void*>(p)) U;
  }
  bool operator==(const Unset&) const = default;
};

// Floats(n) and resize(n) leave them unset; Floats(n, 0.0f) sets them.
using Floats = std::vector<float, Unset<float>>;

}  // namespace tessera
