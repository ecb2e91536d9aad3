// SPDX-License-Identifier: Apache-2.0
// The filter that is none: what is rendered is what is delivered.
#include "core/filter/descriptions.h"

namespace tessera {

FilterDescription describe_none() {
  return {"none", "the noisy image as it is",
          "",     channels_of(Aov::color),
          {},     [](const ParameterValues&) {
            return std::vector<Pass>{}; }};
}

}  // namespace tessera
