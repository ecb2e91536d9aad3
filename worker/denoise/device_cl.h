// SPDX-License-Identifier: Apache-2.0
// A device as its runner sees it: kernels, buffers that are kept between calls, and one queue. Internal to
// worker/denoise; the only header that shows OpenCL.
#pragma once

#define CL_HPP_ENABLE_EXCEPTIONS
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#define CL_HPP_TARGET_OPENCL_VERSION 120
#include <CL/opencl.hpp>
#include <map>
#include <mutex>
#include <span>
#include <string_view>
#include <vector>

#include "core/image.h"
#include "worker/denoise/device.h"

namespace tessera {

// A kernel's run on the device, without the time in the queue.
struct KernelTime {
  std::string kernel;
  double seconds = 0;
};

// A buffer that outlives the filter runs that use it.
struct Workspace {
  Workspace() = default;
  Workspace(Workspace&&) = default;  // never a copy: its buffer would be in the other's memory
  Workspace& operator=(Workspace&&) = default;

  Floats memory;  // the buffer's, where the device shares ours
  cl::Buffer buffer;
  std::size_t room = 0;  // floats
  std::string pads;      // what the pads around its planes hold: whoever finds another value fills them anew
};

class ClDevice : public Device {
 public:
  ClDevice(cl::Device device, DeviceInfo info);
  const DeviceInfo& info() const override { return info_; }

  // Held by whoever uses the members below.
  std::mutex& mutex() { return mutex_; }

  // Pixels a work-item handles at a time: the macro VW of the kernels.
  int vector_width() const { return vector_width_; }
  // The program of `source` behind kernels/common.cl, built on first use with `options`. Throws
  // Error(internal_error) with the build log.
  cl::Program& program(std::string_view source, const std::string& options = {});
  // One work-item per row on a CPU, one per vector elsewhere; the work-group's shape never varies.
  void run(cl::Kernel&, int width, int rows);
  // From now on, what each kernel took is appended to `times` (borrowed) when finish() returns; null: no
  // longer.
  void record(std::vector<KernelTime>* times) { times_ = times; }
  // Caller's memory as a buffer, without a copy where the device shares it. It must outlive the buffer.
  cl::Buffer borrowed(std::span<const float>);
  cl::Buffer borrowed(std::span<float>);
  // Waits until all is done and `memory`, borrowed as `buffer`, holds what the kernels wrote.
  void finish(cl::Buffer& buffer, std::span<float> memory);
  void fill(cl::Buffer&, float value, std::size_t first, std::size_t count);

  // Buffer number `slot` with room for `floats`, kept and only ever grown.
  Workspace& workspace(int slot, std::size_t floats);

  // An image to be written to, whatever it holds, in the memory of the one that was given back last.
  Image image(const Region&, int planes);
  void give_back(Image image) { spare_ = std::move(image); }

 private:
  cl::Device device_;
  DeviceInfo info_;
  cl::Context context_;
  cl::CommandQueue queue_;
  int vector_width_;
  std::mutex mutex_;
  std::map<std::string, cl::Program> programs_;  // by options and source
  std::vector<Workspace> workspaces_;
  Image spare_;
  std::vector<KernelTime>* times_ = nullptr;
  std::vector<cl::Event> events_;  // of the entries of *times_ that have no time yet
};

// Turns an OpenCL failure into an Error that says what was being done.
[[noreturn]] void rethrow(const cl::Error&, const DeviceInfo&);

}  // namespace tessera
