// SPDX-License-Identifier: Apache-2.0
#include "worker/denoise/runner.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "core/error.h"
#include "worker/denoise/device_cl.h"
#include "worker/denoise/recipe.h"

namespace tessera {
namespace {

constexpr int kLine = 16;  // floats of a cache line
enum Slot { kGuides, kEven, kOdd };

int rounded_up(int v, int step) { return (v + step - 1) / step * step; }

// Where a tile's outer region lies in the padded planes of the workspace.
struct Layout {
  int pad = 0;               // columns left of the region; rows above and below
  int stride = 0, rows = 0;  // of a plane
  cl_long plane = 0;         // floats from one plane to the next
  cl_long origin = 0;        // of the region's first pixel

  // Room for the widest reach on each side, and on the right for the rest of a vector. Rows and planes start
  // on different cache sets, for a kernel reads many of them at once.
  Layout(const Region& outer, int reach, int vector) {
    pad = rounded_up(std::max(reach, 1), kLine);
    stride = rounded_up(pad + outer.width() + reach + 2 * vector, kLine);
    if (stride / kLine % 2 == 0) stride += kLine;
    rows = outer.height() + 2 * pad;
    const cl_long lines = cl_long(stride) * rows / kLine;
    plane = (lines + (71 - lines % 64) % 64) * kLine;
    origin = cl_long(pad) * stride + pad;
  }
};

// The region each pass computes, first to last: what the later passes still read, cut to the frame.
std::vector<Region> regions_of(const std::vector<Pass>& passes, const Region& inner, const Region& frame) {
  std::vector<Region> regions(passes.size());
  int later = 0;
  for (std::size_t i = passes.size(); i-- > 0; later += passes[i].radius)
    regions[i] = intersect(grown(inner, later), frame);
  return regions;
}

template <typename... Arguments>
void set_arguments(cl::Kernel& kernel, const Arguments&... arguments) {
  cl_uint index = 0;
  (kernel.setArg(index++, arguments), ...);
}

// One call of filter(): borrows the device, which is locked.
class Run {
 public:
  Run(ClDevice& device, const FilterPlan& plan, const Tile& tile)
      : device_(device),
        recipe_(recipe_of(plan.name)),
        outer_(tile.outer),
        passes_(plan.passes()),
        layout_(outer_, reach(), device.vector_width()),
        program_(device.program(recipe_.source, recipe_.options(plan))) {}

  Image filter(const FilterPlan& plan, const Image& input, const Tile& tile, const Region& frame) {
    lay_out();
    cl::Buffer in = device_.borrowed(input.data());
    prepare(in);
    const std::vector<Region> regions = regions_of(passes_, tile.inner, frame);
    for (std::size_t i = 0; i < passes_.size(); ++i) {
      run(passes_[i], recipe_.scalars(plan, passes_[i]), regions[i]);
      std::swap(from_, to_);
    }
    return collect(in, tile.inner);
  }

 private:
  int reach() const {
    int most = 0;
    for (const Pass& p : passes_) most = std::max(most, p.radius);
    return most;
  }

  cl::Buffer& buffer(Slot slot) {
    const int planes = slot == kGuides ? recipe_.guide_planes : recipe_.signal_planes;
    return device_.workspace(slot, static_cast<std::size_t>(layout_.plane) * planes + kLine);
  }

  // Fills the pads, unless the last call left them as this one needs them: see kernels/common.cl.
  void lay_out() {
    for (const Slot s : {kGuides, kEven, kOdd}) buffer(s);
    std::string now = fmt::format("{} {} {} {}", recipe_.name, outer_.width(), outer_.height(), layout_.pad);
    if (device_.workspace_layout() == now) return;
    const std::size_t plane = static_cast<std::size_t>(layout_.plane);
    device_.fill(buffer(kGuides), std::numeric_limits<float>::infinity(), 0, plane);
    device_.fill(buffer(kGuides), 0, plane, plane * (recipe_.guide_planes - 1));
    for (const Slot s : {kEven, kOdd}) device_.fill(buffer(s), 0, 0, plane * recipe_.signal_planes);
    device_.workspace_layout() = std::move(now);
  }

  void prepare(const cl::Buffer& in) {
    cl::Kernel kernel(program_, "prepare");
    set_arguments(kernel, in, outer_.width(), outer_.height(), buffer(kGuides), buffer(from_), layout_.stride,
                  layout_.plane, layout_.origin, kSkyDepth);
    device_.run(kernel, outer_.width(), outer_.height());
  }

  // Vectors start at multiples of their width in the outer region, wherever the region to compute starts: the
  // lanes in front and behind hold pixels that no later pass reads, or the pad.
  void run(const Pass& pass, const cl_float4& scalars, const Region& region) {
    const int vector = device_.vector_width();
    const int x0 = (region.x0 - outer_.x0) / vector * vector, x1 = region.x1 - outer_.x0;
    const int y0 = region.y0 - outer_.y0, y1 = region.y1 - outer_.y0;
    cl::Kernel kernel(program_, std::string(pass.kernel).c_str());
    set_arguments(kernel, buffer(kGuides), buffer(from_), buffer(to_), layout_.stride, layout_.plane,
                  layout_.origin, x0, y0, x1, y1, pass.step, scalars);
    device_.run(kernel, x1 - x0, rounded_up(y1 - y0, pass.step));
  }

  Image collect(const cl::Buffer& in, const Region& inner) {
    Image result(inner, 3);
    cl::Buffer out = device_.borrowed(result.data());
    cl::Kernel kernel(program_, "finish");
    set_arguments(kernel, in, outer_.width(), outer_.height(), buffer(kGuides), buffer(from_), layout_.stride,
                  layout_.plane, layout_.origin, inner.x0 - outer_.x0, inner.y0 - outer_.y0,
                  inner.x1 - outer_.x0, inner.y1 - outer_.y0, out);
    device_.run(kernel, inner.width(), inner.height());
    device_.finish(out, result.data());
    return result;
  }

  ClDevice& device_;
  const Recipe& recipe_;
  Region outer_;
  std::vector<Pass> passes_;
  Layout layout_;
  cl::Program& program_;
  Slot from_ = kEven, to_ = kOdd;
};

void check(const FilterPlan& plan, const Image& input, const Tile& tile, const Region& frame) {
  const Region needed = intersect(grown(tile.inner, plan.halo()), frame);
  constexpr std::int64_t kMost = std::int64_t{1} << 30;  // pixels of a plane: indices in kernels are ints
  if (tile.inner.empty() || !frame.contains(tile.inner) || tile.outer != needed || tile.outer.area() > kMost)
    throw Error(ExitCode::bad_input,
                fmt::format("filter task: the tile's outer region is not its inner region"
                            " grown by {} and cut to the frame",
                            plan.halo()));
  if (input.region() != tile.outer || input.planes() != static_cast<int>(plan.description().inputs.size()))
    throw Error(ExitCode::bad_input,
                fmt::format("filter '{}' takes {} planes over the tile's outer region; got {}", plan.name,
                            plan.description().inputs.size(), input.planes()));
}

}  // namespace

Image filter(Device& device, const FilterPlan& plan, const Image& input, const Tile& tile,
             const Region& frame) {
  check(plan, input, tile, frame);
  if (plan.passes().empty()) return cropped(input, tile.inner);
  ClDevice& cl = dynamic_cast<ClDevice&>(device);
  const std::lock_guard lock(cl.mutex());
  try {
    return Run(cl, plan, tile).filter(plan, input, tile, frame);
  } catch (const cl::Error& e) {
    rethrow(e, cl.info());
  }
}

Filtered filter_task(Device& device, const FilterPlan& plan, const Image& sums, const FilmLayout& layout,
                     const Tile& tile, const Region& frame) {
  Filtered result(tile.inner, kFilteredPlanes);
  auto to = result.data().begin();
  for (const Part part : {Part::all, Part::a, Part::b}) {
    const Image input = developed(sums, layout, plan.description().inputs, part);
    const Image output = filter(device, plan, input, tile, frame);
    to = std::ranges::copy(output.data(), to).out;
  }
  return result;
}

}  // namespace tessera
