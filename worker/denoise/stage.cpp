// SPDX-License-Identifier: Apache-2.0
#include "worker/denoise/stage.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"

namespace tessera {
namespace {

constexpr int kLine = 16;  // floats of a cache line

std::vector<Region> regions_of(const std::vector<Pass>& passes, const Region& inner, const Region& frame) {
  std::vector<Region> regions(passes.size());
  int later = 0;
  for (std::size_t i = passes.size(); i-- > 0; later += passes[i].radius)
    regions[i] = intersect(grown(inner, later), frame);
  return regions;
}

int reach_of(const std::vector<Pass>& passes) {
  int most = 0;
  for (const Pass& p : passes) most = std::max(most, p.radius);
  return most;
}

std::string upper_case(std::string_view text) {
  std::string upper;
  for (const char c : text)
    if (c != '_') upper += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return upper;
}

// IN_<AOV>[_VARIANCE|_THIRD][_A|_B], IN_SAMPLES[_A|_B]: the first plane of each group in the input, and SKY.
std::string input_macros(const FilterPlan& plan) {
  constexpr std::string_view kStatistics[] = {"", "_VARIANCE", "_THIRD", ""}, kShares[] = {"", "_A", "_B"};
  std::string text = fmt::format(" -DSKY={:e}f", kSkyDepth);
  const std::vector<Channel> inputs = plan.inputs();
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    const Channel& c = inputs[k];
    if (c.index != 0) continue;
    const std::string name = c.statistic == Statistic::samples ? "SAMPLES"
                             : c.aov == Aov::color             ? "COLOR"
                             : c.aov == Aov::depth             ? "DEPTH"
                                                               : upper_case(info(c.aov).name);
    text += fmt::format(" -DIN_{}{}{}={}", name, kStatistics[static_cast<int>(c.statistic)],
                        kShares[static_cast<int>(c.share)], k);
  }
  return text;
}

std::string joined(const std::vector<std::string_view>& sources) {
  std::string text;
  for (const std::string_view s : sources) text += s;
  return text;
}

}  // namespace

int rounded_up(int v, int step) { return (v + step - 1) / step * step; }

// Rows and planes start on different cache sets, for a kernel reads many of them at once.
Layout::Layout(const Region& outer, int reach, int vector) {
  pad = rounded_up(reach + 1, kLine);
  stride = rounded_up(pad + outer.width() + reach + 2 * vector, kLine);
  if (stride / kLine % 2 == 0) stride += kLine;
  rows = outer.height() + 2 * pad;
  const cl_long lines = cl_long(stride) * rows / kLine;
  plane = (lines + (71 - lines % 64) % 64) * kLine;
  origin = cl_long(pad) * stride + pad;
}

Stage::Stage(ClDevice& device, const FilterPlan& plan, const std::vector<std::string_view>& sources,
             const std::string& options, const Image& input, const Tile& tile, const Region& frame,
             const Image& history)
    : device_(device),
      plan_(plan),
      tile_(tile),
      frame_(frame),
      passes_(plan.passes()),
      regions_(regions_of(passes_, tile.inner, frame)),
      layout_(tile.outer, reach_of(passes_), device.vector_width()),
      program_(device.program(joined(sources), options + input_macros(plan))),
      input_(device.borrowed(input.data())),
      result_(device.image(tile.inner, 3 + plan.history())),
      output_(device.borrowed(result_.data())),
      history_region_(history.region()),
      // A kernel's argument is a buffer, though nothing of it be read.
      history_(device.borrowed(history.empty() ? input.data().first(1) : history.data())) {}

// The scratch that a filter's description states is what a tile's memory is planned by.
void Stage::count(std::size_t floats) {
  floats_ += static_cast<double>(floats);
  const double stated = plan_.description().scratch(plan_.parameters) * static_cast<double>(layout_.plane);
  if (floats_ > stated + kLine)
    throw Error(ExitCode::internal_error,
                fmt::format("filter '{}' takes {:.0f} floats of scratch and states {:.0f}", plan_.name,
                            floats_, stated));
}

Planes Stage::planes(const Region& over, const Layout& layout, int count, float first) {
  const std::size_t plane = static_cast<std::size_t>(layout.plane);
  this->count(plane * count);
  Workspace& space = device_.workspace(slots_++, plane * count + kLine);
  std::string now = fmt::format("{} {} {} {} {} {} {}", over.width(), over.height(), layout.stride,
                                layout.plane, layout.origin, count, first);
  if (space.pads != now) {
    device_.fill(space.buffer, first, 0, plane);
    device_.fill(space.buffer, 0, plane, plane * (count - 1));
    space.pads = std::move(now);
  }
  return {space.buffer};
}

Planes Stage::scratch(std::size_t floats) {
  count(floats);
  Workspace& space = device_.workspace(slots_++, floats + kLine);
  space.pads.clear();
  return {space.buffer};
}

cl::Buffer Stage::table(std::vector<cl_int> values) {
  static_assert(sizeof(cl_int) == sizeof(float));
  const auto& kept = tables_.emplace_back(std::move(values));
  return device_.borrowed(std::span(reinterpret_cast<const float*>(kept.data()), kept.size()));
}

void Stage::set(cl::Kernel& kernel, cl_uint& index, const Layout& l) {
  kernel.setArg(index++, cl_int{l.stride});
  kernel.setArg(index++, l.plane);
  kernel.setArg(index++, l.origin);
}

void Stage::set_corners(cl::Kernel& kernel, cl_uint& index, int x0, const Region& r) {
  for (const int v : {x0, r.y0, r.x1, r.y1}) kernel.setArg(index++, cl_int{v});
}

void Stage::set(cl::Kernel& kernel, cl_uint& index, const Region& r) {
  const Region relative{r.x0 - outer().x0, r.y0 - outer().y0, r.x1 - outer().x0, r.y1 - outer().y0};
  set_corners(kernel, index, relative.x0 / vector() * vector(), relative);
}

void Stage::set(cl::Kernel& kernel, cl_uint& index, const Within& in) {
  const Region &r = in.region, &o = in.outer;
  set_corners(kernel, index, r.x0 - o.x0, {r.x0 - o.x0, r.y0 - o.y0, r.x1 - o.x0, r.y1 - o.y0});
}

void Stage::set(cl::Kernel& kernel, cl_uint& index, const Past&) {
  set(kernel, index, history_);
  set(kernel, index, Within{history_region_, {}});
  for (const int v : {outer().x0, outer().y0}) kernel.setArg(index++, cl_int{v});
}

void Stage::enqueue(cl::Kernel& kernel, const Region& over, int step) {
  device_.run(kernel, over.width() + vector() - 1, rounded_up(over.height(), step));
}

Image Stage::finish() {
  device_.finish(output_, result_.data());
  return std::move(result_);
}

}  // namespace tessera
