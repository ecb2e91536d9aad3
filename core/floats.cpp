// SPDX-License-Identifier: Apache-2.0
#include "core/floats.h"

#include <sys/mman.h>

#include <cstdlib>

namespace tessera {

void* plane_memory(std::size_t bytes) {
  constexpr std::size_t kLargePage = 2 << 20;
  const bool large = bytes >= 4 * kLargePage;  // what alignment may waste is little then
  void* memory = nullptr;
  if (large)
    memory = std::aligned_alloc(kLargePage, (bytes + kLargePage - 1) / kLargePage * kLargePage);
  else
    memory = std::malloc(bytes);
  if (!memory && bytes > 0) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
  if (large) madvise(memory, bytes, MADV_HUGEPAGE);  // advice: that it is not taken is no failure
#endif
  return memory;
}

void free_plane_memory(void* memory) noexcept { std::free(memory); }

}  // namespace tessera
