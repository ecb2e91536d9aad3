// SPDX-License-Identifier: Apache-2.0
// The metrics of `tessera compare` by name: what each is of, the figures it gives, and its error per pixel.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/quality/display.h"
#include "core/quality/error_map.h"
#include "core/quality/flip.h"

namespace tessera {

// A figure with all that must stand beside it. `exposure` is set if the figure is of displayed values.
struct Figure {
  std::string key, label;
  double value = 0;
  std::string domain;  // "linear", "sRGB", "gamma 2.2"
  std::optional<float> exposure;
  std::string remark;
  bool higher_is_better = false;
};

// Of displayed values.
Figure displayed_figure(std::string key, std::string label, double value, const Display&,
                        std::string remark = {});

// An image and its reference, as every metric may want them. Refers to x and r.
struct Subjects {
  Subjects(const Image& x, const Image& r, const Display&, double pixels_per_degree, Size tile);

  const Image &x, &r;  // linear
  Display display;
  Image shown_x, shown_r;  // displayed values
  double ppd;
  FlipKernels kernels;
  Size tile;
};

struct Judgement {
  std::vector<Figure> figures;
  ErrorMap errors;  // without values if the metric has none
};

struct Metric {
  std::string_view name, what;
  bool has_map;
  bool up_to_one;  // errors of pixels are between 0 and 1
  Judgement (*judge)(const Subjects&);
};

std::span<const Metric> metrics();

// Throws Error (bad usage) that names `option` for one that does not exist; and for one without errors of
// pixels, if they are needed.
const Metric& metric_named(std::string_view name, std::string_view option, bool needs_map);

}  // namespace tessera
