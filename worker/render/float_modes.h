// SPDX-License-Identifier: Apache-2.0
// Modes of the processor's float unit that the bits of a result depend on: set where they matter, never
// inherited.
#pragma once

#include <pmmintrin.h>

namespace tessera::tracer {

// While it lives, this thread rounds to nearest and denormal results and operands are zero.
class FlushToZero {
 public:
  FlushToZero() : before_(_mm_getcsr()) { _mm_setcsr(0x1f80u | _MM_FLUSH_ZERO_ON | _MM_DENORMALS_ZERO_ON); }
  ~FlushToZero() { _mm_setcsr(before_); }
  FlushToZero(const FlushToZero&) = delete;
  FlushToZero& operator=(const FlushToZero&) = delete;

 private:
  unsigned before_;
};

}  // namespace tessera::tracer
