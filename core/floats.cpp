// SPDX-License-Identifier: Apache-2.0
#include "core/floats.h"

#include <sys/mman.h>

#include <cstdlib>

namespace tessera {
namespace {

constexpr std::size_t kLine = 64, kLargePage = 2 << 20;

}  // namespace

void* plane_memory(std::size_t bytes) {
  const bool large = bytes >= 2 * kLargePage;
  void* memory = nullptr;
  if (posix_memalign(&memory, large ? kLargePage : kLine, bytes) != 0) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
  if (large) madvise(memory, bytes, MADV_HUGEPAGE);  // advice: that it is not taken is no failure
#endif
  return memory;
}

void free_plane_memory(void* memory) noexcept { std::free(memory); }

}  // namespace tessera
