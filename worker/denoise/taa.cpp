// SPDX-License-Identifier: Apache-2.0
#include "worker/denoise/taa.h"

#include "core/filter/taa.h"

namespace tessera {

Picture picture(Stage& s) {
  if (!with_taa(s.plan().parameters)) return {s.inner(), s.output()};
  const Region seen = intersect(grown(s.inner(), s.passes().back().radius), s.frame());
  return {seen, s.scratch(static_cast<std::size_t>(seen.area()) * 3).buffer};
}

void taa(Stage& s, const Picture& p) {
  const FilterPlan& plan = s.plan();
  if (!with_taa(plan.parameters)) return;
  s.run("taa", s.inner(), 1, s.input(), s.outer().width(), s.outer().height(), p.buffer, Exactly{p.region},
        Past{}, cl_int{plan.history() - kTaaPlanes}, static_cast<float>(plan["taa_alpha"]),
        static_cast<float>(plan["taa_gamma"]), Exactly{s.inner()}, s.output());
}

}  // namespace tessera
