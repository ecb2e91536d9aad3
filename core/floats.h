// SPDX-License-Identifier: Apache-2.0
// Vectors of floats whose new elements are unset until written: planes are written whole, and setting
// gigabytes to zero first is a second pass over them.
#pragma once

#include <memory>
#include <new>
#include <vector>

namespace tessera {

template <class T>
struct Unset : std::allocator<T> {
  Unset() = default;
  template <class U>
  Unset(const Unset<U>&) {}
  template <class U>
  struct rebind {
    using other = Unset<U>;
  };
  template <class U>
  void construct(U* p) noexcept {
    ::new (static_cast<void*>(p)) U;
  }
  template <class U, class... A>
  void construct(U* p, A&&... a) {
    ::new (static_cast<void*>(p)) U(std::forward<A>(a)...);
  }
};

// Floats(n) and resize(n) leave them unset; Floats(n, 0.0f) sets them.
using Floats = std::vector<float, Unset<float>>;

}  // namespace tessera
