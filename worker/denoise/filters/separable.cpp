// SPDX-License-Identifier: Apache-2.0
// Box and Gaussian: along the rows, then along the columns.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "kernels.h"
#include "worker/denoise/programs.h"

namespace tessera {
namespace {

void run(Stage& s) {
  const Planes signal = s.planes(4);
  const Planes means = s.scratch(4 * static_cast<std::size_t>(s.layout().plane));
  const Region along_rows{s.inner().x0, s.outer().y0, s.inner().x1, s.outer().y1};
  s.run("prepare", s.outer(), 1, s.input(), s.outer().width(), s.outer().height(), signal, s.layout());
  s.run("rows", along_rows, 1, signal, means, s.layout(), along_rows);
  s.run("columns", s.inner(), 1, s.input(), s.outer().width(), s.outer().height(), signal, means, s.layout(),
        Exactly{s.inner()}, s.output());
}

std::string weights(const FilterPlan& plan, double sigma) {
  const int radius = plan.passes().back().radius;
  std::string text = fmt::format("-DRADIUS={} -DWEIGHTS=1.0f", radius);
  for (int i = 1; i <= radius; ++i) text += fmt::format(",{:.9e}f", std::exp(-i * i / (2 * sigma * sigma)));
  return text;
}

}  // namespace

Program box_program() {
  return {"box",
          {kernels::separable_cl},
          [](const FilterPlan& plan) { return weights(plan, std::numeric_limits<double>::infinity()); },
          run};
}

Program gaussian_program() {
  return {"gaussian",
          {kernels::separable_cl},
          [](const FilterPlan& plan) { return weights(plan, plan["sigma"]); },
          run};
}

}  // namespace tessera
