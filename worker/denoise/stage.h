// SPDX-License-Identifier: Apache-2.0
// One run of a filter over one tile: its planes on the device, its kernels over parts of the tile, its
// output. Each file in filters/ says in these words what a filter does. Internal to worker/denoise.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "core/filter/filter.h"
#include "core/image.h"
#include "worker/denoise/device_cl.h"

namespace tessera {

int rounded_up(int v, int step);  // to a multiple of step

// Where a tile's outer region lies in padded planes; all planes of a run lie alike.
struct Layout {
  int pad = 0;               // columns left of the region; rows above and below
  int stride = 0, rows = 0;  // of a plane
  cl_long plane = 0;         // floats from one plane to the next
  cl_long origin = 0;        // of the region's first pixel

  // Room for more than `reach` pixels on each side, and on the right for the rest of a vector.
  Layout() = default;
  Layout(const Region& outer, int reach, int vector);
};

// Planes of one workspace buffer. As a kernel's argument it is the buffer.
struct Planes {
  cl::Buffer buffer;
};

// A region as a kernel's argument: x0, y0, x1, y1 relative to the outer region. Of a Region, x0 is moved left
// to a multiple of the vector width: the lanes in front hold pixels that no later pass reads. Of Exactly, it
// is not. Of Within, it is relative to `outer` instead, as a region of another grid is.
struct Exactly {
  Region region;
};
struct Within {
  Region region, outer;
};
// The history and where it and the outer region lie in the frame's grid: PAST_ARGUMENTS of
// kernels/history.cl.
struct Past {};

class Stage {
 public:
  // `input`, `history`, `plan` and what `sources` view must outlive the stage. The device is locked by the
  // caller.
  Stage(ClDevice&, const FilterPlan&, const std::vector<std::string_view>& sources,
        const std::string& options, const Image& input, const Tile& tile, const Region& frame,
        const Image& history);

  const FilterPlan& plan() const { return plan_; }
  const Region& frame() const { return frame_; }
  const Region& outer() const { return tile_.outer; }
  const Region& inner() const { return tile_.inner; }
  int vector() const { return device_.vector_width(); }
  const std::vector<Pass>& passes() const { return passes_; }
  // What pass number i computes: all that later passes still read, cut to the frame.
  const Region& region(std::size_t i) const { return regions_[i]; }

  // Arguments of kernels.
  const cl::Buffer& input() const { return input_; }    // plan.inputs(), plane after plane over outer()
  const cl::Buffer& output() const { return output_; }  // RGB, then plan.history() planes, over inner()
  // What was kept of the frame before: planes over history_region(), which is empty if there is nothing.
  const cl::Buffer& history() const { return history_; }
  const Region& history_region() const { return history_region_; }
  const Layout& layout() const { return layout_; }  // stride, plane, origin

  // `count` planes. Their pads hold `first` in plane 0, and 0 in all others: which kernels have to leave so,
  // for the pads are filled only when they do not hold that already.
  Planes planes(int count, float first = 0) { return planes(outer(), layout_, count, first); }
  // The same over another grid's region.
  Planes planes(const Region& over, const Layout&, int count, float first = 0);
  // Memory without any promise: `floats` of it.
  Planes scratch(std::size_t floats);
  // Numbers that the kernels look up.
  cl::Buffer table(std::vector<cl_int> values);

  // Runs a kernel with a work-item (on CPUs) per row of `over`, its height rounded up to a multiple of
  // `step`. Arguments are set in order; a Layout counts as three, a region as four,
  // the Past as seven.
  template <typename... Arguments>
  void run(const char* kernel, const Region& over, int step, const Arguments&... arguments) {
    cl::Kernel k(program_, kernel);
    cl_uint index = 0;
    (set(k, index, arguments), ...);
    enqueue(k, over, step);
  }

  // Waits for all kernels. What was written to output().
  Image finish();

 private:
  template <typename T>
  void set(cl::Kernel& kernel, cl_uint& index, const T& value) {
    kernel.setArg(index++, value);
  }
  void set(cl::Kernel& kernel, cl_uint& index, const Planes& p) { kernel.setArg(index++, p.buffer); }
  void set(cl::Kernel&, cl_uint& index, const Layout&);
  void set(cl::Kernel&, cl_uint& index, const Region&);
  void set(cl::Kernel& k, cl_uint& index, const Exactly& e) { set(k, index, Within{e.region, outer()}); }
  void set(cl::Kernel&, cl_uint& index, const Within&);
  void set(cl::Kernel&, cl_uint& index, const Past&);
  void set_corners(cl::Kernel&, cl_uint& index, int x0, const Region& relative);
  void enqueue(cl::Kernel&, const Region& over, int step);
  void count(std::size_t floats);

  ClDevice& device_;
  const FilterPlan& plan_;
  Tile tile_;
  Region frame_;
  std::vector<Pass> passes_;
  std::vector<Region> regions_;
  Layout layout_;
  cl::Program& program_;
  cl::Buffer input_;
  Image result_;
  cl::Buffer output_;
  Region history_region_;
  cl::Buffer history_;
  std::deque<std::vector<cl_int>> tables_;  // borrowed by the device
  int slots_ = 0;
  double floats_ = 0;  // of workspace in use
};

}  // namespace tessera
