// SPDX-License-Identifier: Apache-2.0
#include "worker/denoise/device.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>

#include "core/error.h"
#include "kernels.h"
#include "worker/denoise/device_cl.h"

namespace tessera {
namespace {

std::string kind_of(cl_device_type type) {
  return type & CL_DEVICE_TYPE_CPU ? "cpu" : type & CL_DEVICE_TYPE_GPU ? "gpu" : "other";
}

DeviceInfo describe(const cl::Platform& platform, const cl::Device& device) {
  return {.name = device.getInfo<CL_DEVICE_NAME>(),
          .platform = platform.getInfo<CL_PLATFORM_NAME>(),
          .version = device.getInfo<CL_DEVICE_VERSION>(),
          .driver = device.getInfo<CL_DRIVER_VERSION>(),
          .kind = kind_of(device.getInfo<CL_DEVICE_TYPE>()),
          .compute_units = static_cast<int>(device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>()),
          .native_float_width = static_cast<int>(device.getInfo<CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT>()),
          .memory = device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>()};
}

struct Found {
  cl::Device device;
  DeviceInfo info;
};

// Platforms and devices in the order in which the loader names them. No platform is no failure.
std::vector<Found> find_devices() {
  std::vector<Found> found;
  try {
    std::vector<cl::Platform> platforms;
    cl::Platform::get(&platforms);
    for (const cl::Platform& platform : platforms) {
      std::vector<cl::Device> devices;
      try {
        platform.getDevices(CL_DEVICE_TYPE_ALL, &devices);
      } catch (const cl::Error&) {
        continue;  // a platform without devices
      }
      for (const cl::Device& device : devices) found.push_back({device, describe(platform, device)});
    }
  } catch (const cl::Error&) {
    found.clear();  // no platform at all
  }
  return found;
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

const Found* choose(const std::vector<Found>& all, const std::string& which) {
  if (which.empty()) {
    const auto cpu = std::ranges::find(all, "cpu", [](const Found& f) { return f.info.kind; });
    return cpu == all.end() ? nullptr : &*cpu;
  }
  std::size_t index = 0;
  const auto [end, problem] = std::from_chars(which.data(), which.data() + which.size(), index);
  if (problem == std::errc{} && end == which.data() + which.size())
    return index < all.size() ? &all[index] : nullptr;
  for (const Found& f : all)
    if (lower(f.info.name).find(lower(which)) != std::string::npos) return &f;
  return nullptr;
}

// The widest of the kernels' vector widths that the device handles natively; a GPU takes single pixels.
int vector_width_of(const DeviceInfo& info) {
  if (info.kind != "cpu") return 1;
  for (const int width : {16, 8, 4})
    if (info.native_float_width >= width) return width;
  return 1;
}

}  // namespace

std::vector<DeviceInfo> list_devices() {
  std::vector<DeviceInfo> infos;
  for (Found& f : find_devices()) infos.push_back(std::move(f.info));
  return infos;
}

std::unique_ptr<Device> Device::open(const std::string& which) {
  const std::vector<Found> all = find_devices();
  const Found* found = choose(all, which);
  if (!found) {
    std::string text =
        which.empty() ? "no OpenCL CPU device" : fmt::format("no OpenCL device '{}'", which.substr(0, 64));
    text += all.empty() ? "; OpenCL finds none (PoCL is in the package pocl-opencl-icd)" : "; there are:";
    for (std::size_t i = 0; i < all.size(); ++i) text += fmt::format(" {}: {}", i, all[i].info.name);
    throw Error(ExitCode::no_device, text);
  }
  try {
    return std::make_unique<ClDevice>(found->device, found->info);
  } catch (const cl::Error& e) {
    rethrow(e, found->info);
  }
}

ClDevice::ClDevice(cl::Device device, DeviceInfo info)
    : device_(std::move(device)),
      info_(std::move(info)),
      context_(device_),
      queue_(context_, device_, CL_QUEUE_PROFILING_ENABLE),
      vector_width_(vector_width_of(info_)) {}

cl::Program& ClDevice::program(std::string_view source, const std::string& options) {
  std::string all = fmt::format("-cl-std=CL1.2 -cl-denorms-are-zero -DVW={}", vector_width_);
  if (device_.getInfo<CL_DEVICE_SINGLE_FP_CONFIG>() & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT)
    all += " -cl-fp32-correctly-rounded-divide-sqrt";
  if (!options.empty()) all += " " + options;
  const auto [entry, fresh] = programs_.try_emplace(fmt::format("{}\n{}", all, source));
  if (!fresh) return entry->second;
  cl::Program program(context_, fmt::format("{}\n{}", kernels::common_cl, source));
  try {
    program.build({device_}, all.c_str());
  } catch (const cl::Error&) {
    programs_.erase(entry);
    throw Error(ExitCode::internal_error,
                fmt::format("{}: kernels do not build with {}:\n{}", info_.name, all,
                            program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device_)));
  }
  return entry->second = std::move(program);
}

void ClDevice::run(cl::Kernel& kernel, int width, int rows) {
  const bool cpu = info_.kind == "cpu";
  const std::size_t group = cpu ? 1 : 64;
  const std::size_t items = cpu ? 1 : (static_cast<std::size_t>(width) + group - 1) / group * group;
  cl::Event event;
  queue_.enqueueNDRangeKernel(kernel, cl::NullRange, {items, static_cast<std::size_t>(rows)}, {group, 1},
                              nullptr, &event);
  if (!times_) return;
  times_->push_back({kernel.getInfo<CL_KERNEL_FUNCTION_NAME>()});
  events_.push_back(std::move(event));
}

cl::Buffer ClDevice::borrowed(std::span<const float> memory) {
  return {context_, CL_MEM_READ_ONLY | CL_MEM_USE_HOST_PTR, memory.size_bytes(),
          const_cast<float*>(memory.data())};
}

cl::Buffer ClDevice::borrowed(std::span<float> memory) {
  return {context_, CL_MEM_WRITE_ONLY | CL_MEM_USE_HOST_PTR, memory.size_bytes(), memory.data()};
}

void ClDevice::finish(cl::Buffer& buffer, std::span<float> memory) {
  void* mapped = queue_.enqueueMapBuffer(buffer, CL_TRUE, CL_MAP_READ, 0, memory.size_bytes());
  queue_.enqueueUnmapMemObject(buffer, mapped);
  queue_.finish();
  for (std::size_t i = 0; i < events_.size(); ++i) {
    const cl_ulong begin = events_[i].getProfilingInfo<CL_PROFILING_COMMAND_START>();
    const cl_ulong end = events_[i].getProfilingInfo<CL_PROFILING_COMMAND_END>();
    (*times_)[times_->size() - events_.size() + i].seconds = 1e-9 * static_cast<double>(end - begin);
  }
  events_.clear();
}

void ClDevice::fill(cl::Buffer& buffer, float value, std::size_t first, std::size_t count) {
  if (count > 0) queue_.enqueueFillBuffer(buffer, value, first * sizeof(float), count * sizeof(float));
}

Workspace& ClDevice::workspace(int slot, std::size_t floats) {
  if (static_cast<std::size_t>(slot) >= workspaces_.size())
    workspaces_.resize(static_cast<std::size_t>(slot) + 1);
  Workspace& space = workspaces_[static_cast<std::size_t>(slot)];
  if (floats > space.room) {
    space = {};  // the old one goes before the new one comes
    if (info_.kind == "cpu") space.memory = Floats(floats);
    const bool ours = !space.memory.empty();
    space.buffer = cl::Buffer(context_, CL_MEM_READ_WRITE | (ours ? CL_MEM_USE_HOST_PTR : 0), floats * sizeof(float),
                              ours ? space.memory.data() : nullptr);
    space.room = floats;
  }
  return space;
}

Image ClDevice::image(const Region& region, int planes) {
  Image image = std::exchange(spare_, {});
  image.reshape(region, planes);
  return image;
}

void rethrow(const cl::Error& e, const DeviceInfo& info) {
  const bool memory = e.err() == CL_MEM_OBJECT_ALLOCATION_FAILURE || e.err() == CL_OUT_OF_HOST_MEMORY ||
                      e.err() == CL_OUT_OF_RESOURCES || e.err() == CL_INVALID_BUFFER_SIZE;
  throw Error(memory ? ExitCode::out_of_memory : ExitCode::internal_error,
              fmt::format("OpenCL device '{}': {} failed with code {}{}", info.name, e.what(), e.err(),
                          memory ? " (not enough memory; smaller tiles need less)" : ""));
}

}  // namespace tessera
