// SPDX-License-Identifier: Apache-2.0
// A short list in place: making and copying it costs what it holds, not what it could hold.
#pragma once

#include <cassert>
#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>

namespace tessera::tracer {

// Up to N items.
template <typename T, std::size_t N>
class Few {
  static_assert(std::is_trivially_destructible_v<T>);

 public:
  Few() {}
  Few(const Few& other) { *this = other; }
  Few& operator=(const Few& other) {
    size_ = other.size_;
    std::uninitialized_copy(other.begin(), other.end(), begin());
    return *this;
  }

  void add(const T& item) {
    assert(size_ < N);
    new (begin() + size_++) T(item);
  }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T& operator[](std::size_t i) { return begin()[i]; }
  const T& operator[](std::size_t i) const { return begin()[i]; }
  T* begin() { return reinterpret_cast<T*>(room_); }
  T* end() { return begin() + size_; }
  const T* begin() const { return reinterpret_cast<const T*>(room_); }
  const T* end() const { return begin() + size_; }

 private:
  std::size_t size_ = 0;
  alignas(T) std::byte room_[N * sizeof(T)];
};

}  // namespace tessera::tracer
