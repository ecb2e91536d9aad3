// SPDX-License-Identifier: Apache-2.0
// The filter that is none: what is rendered is what is delivered.
#include "core/filter/descriptions.h"

namespace tessera {

FilterDescription describe_none() {
  return {.name = "none",
          .summary = "the noisy image as it is",
          .source = "",
          .parameters = {},
          .inputs = [](const ParameterValues&) { return channels_of(Aov::color); },
          .passes = [](const ParameterValues&) { return std::vector<Pass>{}; },
          .scratch = [](const ParameterValues&) { return 0.0; }};
}

}  // namespace tessera
