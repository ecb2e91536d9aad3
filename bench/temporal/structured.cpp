// SPDX-License-Identifier: Apache-2.0
#include "bench/temporal/structured.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "bench/judging/sheet.h"
#include "bench/judging/table.h"
#include "core/png.h"
#include "worker/denoise/runner.h"

namespace tessera::temporal {
namespace {

constexpr Region kFrame{0, 0, 512, 128};
constexpr int kBands = 8;
constexpr float kMost = 0.99f;  // alpha at the right edge

float alpha_at(int x) { return kMost * static_cast<float>(x) / static_cast<float>(kFrame.width() - 1); }

// Above, a chessboard of finer and finer squares; below, rings of finer and finer widths.
float pattern(int x, int y) {
  const int half = kFrame.height() / 2;
  if (y < half) return ((x >> 3) + (y >> (y < half / 2 ? 3 : 2))) % 2 == 0 ? 1.0f : 0.0f;
  const double dx = x % half - half / 2, dy = y - half - half / 2;
  return 0.5f + 0.5f * static_cast<float>(std::cos((dx * dx + dy * dy) * 0.012));
}

// The mean of `samples` samples of each pixel.
Image noisy(std::mt19937& random, int samples) {
  Image image(kFrame, 1);
  for (int y = kFrame.y0; y < kFrame.y1; ++y)
    for (int x = kFrame.x0; x < kFrame.x1; ++x) {
      const float alpha = alpha_at(x);
      int hits = 0;
      for (int i = 0; i < samples; ++i)
        hits += static_cast<float>(random() >> 8) / 16777216.0f >= alpha ? 1 : 0;
      image.at(0, x, y) =
          pattern(x, y) * static_cast<float>(hits) / static_cast<float>(samples) / (1 - alpha);
    }
  return image;
}

// A white wall before a camera at rest, lit directly by what `light` says.
Image input_of(const FilterPlan& plan, const Image& light) {
  const std::vector<Channel> inputs = plan.inputs();
  Image image(kFrame, static_cast<int>(inputs.size()));
  for (int k = 0; k < image.planes(); ++k) {
    const Channel& c = inputs[static_cast<std::size_t>(k)];
    float v = 0;
    if (c.statistic == Statistic::samples || c.aov == Aov::albedo || c.aov == Aov::object_id ||
        c.aov == Aov::material_id)
      v = 1;
    if ((c.aov == Aov::normal || c.aov == Aov::geometric_normal) && c.index == 2) v = 1;
    if (c.aov == Aov::depth || c.aov == Aov::previous_depth) v = 5;
    if (c.statistic == Statistic::variance_of_mean) v = 0;
    std::ranges::fill(image.plane(k), v);
    if (c.statistic == Statistic::mean && (c.aov == Aov::direct || c.aov == Aov::color))
      std::ranges::copy(light.plane(0), image.plane(k).begin());
    if (c.aov == Aov::position && c.index < 2)
      for (int y = kFrame.y0; y < kFrame.y1; ++y)
        for (int x = kFrame.x0; x < kFrame.x1; ++x)
          image.at(k, x, y) = 0.01f * static_cast<float>(c.index == 0 ? x : y);
  }
  return image;
}

struct Row {
  std::string name, filter;
  int samples = 1;
  Image history = {}, image = {};
  std::vector<double> squares = std::vector<double>(kBands);  // of errors, summed over the frames that count
  int counted = 0;
};

void add_errors(Row& row) {
  for (int y = kFrame.y0; y < kFrame.y1; ++y)
    for (int x = kFrame.x0; x < kFrame.x1; ++x) {
      const double off = double{row.image.at(0, x, y)} - pattern(x, y);
      row.squares[static_cast<std::size_t>(x * kBands / kFrame.width())] += off * off;
    }
  ++row.counted;
}

void advance(Row& row, Device& device, int frame, const Image& light) {
  const FilterPlan plan = resolved(parse_filter(row.filter), {.frame = frame});
  const Image output = filter(device, plan, input_of(plan, light), {kFrame, kFrame}, kFrame, row.history);
  row.image = planes_of(output, 0, 3);
  if (plan.history() > 0) row.history = planes_of(output, 3, plan.history());
}

Image grey(float (*value)(int, int)) {
  Image image(kFrame, 3);
  for (int c = 0; c < 3; ++c)
    for (int y = kFrame.y0; y < kFrame.y1; ++y)
      for (int x = kFrame.x0; x < kFrame.x1; ++x) image.at(c, x, y) = value(x, y);
  return image;
}

}  // namespace

std::string structured(Device& device, int frames, const std::filesystem::path& folder) {
  // An exponential average of weight 0.2 is worth nine samples: what the spatial variance makes of as many.
  Row rows[] = {{"noisy", "none"},
                {"spatial variance", "svgf:variance=spatial"},
                {"spatial variance, 9 samples", "svgf:variance=spatial", 9},
                {"spatiotemporal variance", "svgf:variance=spatial,history=on"},
                {"the same, unfiltered feedback", "svgf:variance=spatial,history=on,feedback=0"},
                {"atrous with history", "atrous:history=on"}};
  std::mt19937 random(1);
  for (int frame = 0; frame < frames; ++frame) {
    const Image one = noisy(random, 1), nine = noisy(random, 9);
    for (Row& row : rows) {
      advance(row, device, frame, row.samples == 1 ? one : nine);
      if (2 * frame >= frames) add_errors(row);
    }
  }
  std::vector<Image> pictures{judging::captioned(grey(pattern), "reference")};
  std::vector<std::string> names, bands;
  for (const Row& row : rows) {
    pictures.push_back(judging::captioned(row.image, row.name));
    names.push_back(row.name);
  }
  write_png(folder / "structured.png", judging::in_rows(pictures, 1));
  for (int b = 0; b < kBands; ++b)
    bands.push_back(fmt::format("{:.2f}–{:.2f}", alpha_at(b * kFrame.width() / kBands),
                                alpha_at((b + 1) * kFrame.width() / kBands - 1)));
  return fmt::format(
             "### Structured noise (Schied et al. 2017, figure 9): RMSE by alpha, linear, last half of {} "
             "frames\n\n",
             frames) +
         judging::table("filter \\ alpha", names, bands,
                        [&](const std::string& name, const std::string& band) -> std::optional<std::string> {
                          const Row& row = *std::ranges::find(rows, name, &Row::name);
                          const auto b =
                              static_cast<std::size_t>(std::ranges::find(bands, band) - bands.begin());
                          const double pixels = double(kFrame.area()) / kBands * row.counted;
                          return fmt::format("{:.4f}", std::sqrt(row.squares[b] / pixels));
                        });
}

}  // namespace tessera::temporal
