// SPDX-License-Identifier: Apache-2.0
// How fast the filters' kernels are, in milliseconds and as a fraction of what this machine can do: its peak
// of fused multiply-adds and its bandwidth are measured in the same run, on the same device.
//   filter_bench [device] [width height]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <limits>
#include <random>

#include "core/error.h"
#include "worker/denoise/device_cl.h"
#include "worker/denoise/runner.h"

namespace tessera {
namespace {

constexpr int kRuns = 25;
constexpr int kPeakRuns = 100;  // short ones: the best falls between other programs' turns

// Operations a pixel of one kernel needs (an fma counts two; divisions, roots and comparisons one), counted
// in the source, and the floats it must at least read and write: each plane once.
struct Cost {
  std::string_view kernel;
  double flops, floats;
};
constexpr double kExp = 15;  // of exp2_of_negative
constexpr double kAtrousTap = 9 + 15 + 6 + kExp + 1 + 7;
constexpr double kGeometry = 2 + 5 + 2 + 7;                     // depth, cosine, bounds, seven squarings
constexpr double kChord = 7.0 / 2;                              // half a depth scale per tap
constexpr double kLightTap = 3 + 5 + 3 + kExp + 1 + 1 + 6 + 3;  // differences, luminance, weight, sums
constexpr Cost kCosts[] = {
    {"atrous_level", 24 * kAtrousTap + 4 * 8 + 20, 6 + 3 + 3},
    {"svgf_variance_samples", 48 * (kGeometry + kChord + kExp + 6) + 20, 4 + 8 + 8},
    {"svgf_variance_spatial", 48 * (kGeometry + kChord + kExp + 2 + 2 * 17) + 40, 4 + 8 + 8},
    {"svgf_level", 24 * (kGeometry + kChord + 2 * kLightTap) + 2 * (9 * 4 + 20) + 20, 4 + 8 + 8},
};

// Surfaces with noise, such that every weight is exercised.
Image noisy_input(const FilterPlan& plan, const Region& frame) {
  const auto& inputs = plan.description().inputs;
  Image image(frame, static_cast<int>(inputs.size()));
  std::minstd_rand random(1);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (int k = 0; k < image.planes(); ++k)
    for (int y = frame.y0; y < frame.y1; ++y)
      for (int x = frame.x0; x < frame.x1; ++x) {
        const float u = uniform(random);
        const Channel& c = inputs[k];
        float v = c.statistic == Statistic::variance_of_mean ? 0.05f * u : u;
        if (c.aov == Aov::normal) v = c.index == 2 ? 1.0f : 0.05f * u;
        if (c.aov == Aov::position) v = 0.01f * (c.index == 0 ? x : c.index == 1 ? y : u);
        if (c.aov == Aov::depth) v = 5 + 0.001f * x + 0.001f * u;
        image.at(k, x, y) = v;
      }
  return image;
}

double best(const std::vector<KernelTime>& times) {
  return std::ranges::min_element(times, {}, &KernelTime::seconds)->seconds;
}

// Fused multiply-adds per second, times two: 16 independent chains in registers.
double peak_flops(ClDevice& device) {
  constexpr std::string_view source =
      "kernel void chains(global float* out) {"
      "  vf a[16];"
      "  for (int k = 0; k < 16; ++k) a[k] = (float)get_global_id(1) + k;"
      "  for (int i = 0; i < 4096; ++i)"
      "    _Pragma(\"unroll\") for (int k = 0; k < 16; ++k) a[k] = fma(a[k], (vf)0.999f, (vf)1e-3f);"
      "  vf sum = 0.0f;"
      "  for (int k = 0; k < 16; ++k) sum += a[k];"
      "  store(sum, out + get_global_id(1) * VW);"
      "}";
  constexpr int kRows = 256;
  cl::Kernel kernel(device.program(source), "chains");
  std::vector<float> out(static_cast<std::size_t>(kRows) * device.vector_width());
  cl::Buffer buffer = device.borrowed(std::span(out));
  kernel.setArg(0, buffer);
  std::vector<KernelTime> times;
  device.record(&times);
  for (int i = 0; i < kPeakRuns; ++i) {
    device.run(kernel, 1, kRows);
    device.finish(buffer, out);
  }
  device.record(nullptr);
  return 2.0 * 16 * 4096 * kRows * device.vector_width() / best(times);
}

// Bytes per second of adding two large arrays into a third.
double bandwidth(ClDevice& device) {
  constexpr std::string_view source =
      "kernel void add(global const float* a, global const float* b, global float* c, int width) {"
      "  const size_t row = (size_t)get_global_id(1) * width;"
      "  FOR_EACH_VECTOR(x, 0, width) store(load(a + row + x) + load(b + row + x), c + row + x);"
      "}";
  constexpr int kWidth = 4096, kRows = 2048;
  std::vector<float> memory[3];
  for (std::vector<float>& m : memory) m.assign(std::size_t{kWidth} * kRows, 1.0f);
  cl::Kernel kernel(device.program(source), "add");
  cl::Buffer a = device.borrowed(std::span<const float>(memory[0]));
  cl::Buffer b = device.borrowed(std::span<const float>(memory[1])),
             c = device.borrowed(std::span(memory[2]));
  kernel.setArg(0, a);
  kernel.setArg(1, b);
  kernel.setArg(2, c);
  kernel.setArg(3, kWidth);
  std::vector<KernelTime> times;
  device.record(&times);
  for (int i = 0; i < kPeakRuns; ++i) {
    device.run(kernel, kWidth, kRows);
    device.finish(c, memory[2]);
  }
  device.record(nullptr);
  return 3.0 * sizeof(float) * kWidth * kRows / best(times);
}

struct Machine {
  double flops, bytes;  // per second
};

void print(std::string_view filter, std::string_view kernel, int step, std::vector<double> seconds,
           double pixels, const Machine& machine) {
  std::ranges::sort(seconds);
  const double fastest = seconds.front(), median = seconds[seconds.size() / 2];
  fmt::print("{:<24}{:<24}{:>4}  {:>7.2f}  {:>7.2f}", filter, kernel, step ? std::to_string(step) : "",
             1e3 * fastest, 1e3 * median);
  if (const auto cost = std::ranges::find(kCosts, kernel, &Cost::kernel); cost != std::end(kCosts)) {
    const double flops = cost->flops * pixels, bytes = sizeof(float) * cost->floats * pixels;
    const double least = std::max(flops / machine.flops, bytes / machine.bytes);
    fmt::print("  {:>6.2f}  {:>6.1f}  {:>6.0f} %  {:>7.0f} %  {:>6.0f} %", 1e-9 * flops, 1e-6 * bytes,
               100 * flops / fastest / machine.flops, 100 * bytes / fastest / machine.bytes,
               100 * least / fastest);
  }
  fmt::print("\n");
}

void measure(ClDevice& device, std::string_view text, const Region& frame, const Machine& machine) {
  const FilterPlan plan = parse_filter(text);
  const Image input = noisy_input(plan, frame);
  std::vector<std::vector<double>> of_kernel;
  std::vector<double> whole;
  std::vector<KernelTime> times;
  filter(device, plan, input, {frame, frame}, frame);
  device.record(&times);
  for (int i = 0; i < kRuns; ++i) {
    times.clear();
    const auto begin = std::chrono::steady_clock::now();
    filter(device, plan, input, {frame, frame}, frame);
    whole.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    of_kernel.resize(times.size());
    for (std::size_t k = 0; k < times.size(); ++k) of_kernel[k].push_back(times[k].seconds);
  }
  device.record(nullptr);
  const std::vector<Pass> passes = plan.passes();
  for (std::size_t k = 0; k < times.size(); ++k) {
    const bool pass = k > 0 && k <= passes.size();  // the first kernel prepares, the last one delivers
    print(text, times[k].kernel, pass ? passes[k - 1].step : 0, of_kernel[k],
          static_cast<double>(frame.area()), machine);
  }
  print(text, "whole filter", 0, whole, static_cast<double>(frame.area()), machine);
}

void run(const std::string& name, const Region& frame) {
  const auto opened = Device::open(name);
  ClDevice& device = dynamic_cast<ClDevice&>(*opened);
  const Machine machine{peak_flops(device), bandwidth(device)};
  fmt::print("{}: vectors of {}, {:.0f} Gflop/s, {:.1f} GB/s; {}x{}, {} runs\n\n", device.info().name,
             device.vector_width(), 1e-9 * machine.flops, 1e-9 * machine.bytes, frame.width(), frame.height(),
             kRuns);
  fmt::print("{:<24}{:<24}{:>4}  {:>7}  {:>7}  {:>6}  {:>6}  {:>8}  {:>9}  {:>8}\n", "filter", "kernel",
             "step", "best ms", "median", "Gflop", "MB", "of flops", "of memory", "of roof");
  for (const std::string_view text : {"atrous", "svgf", "svgf:variance=spatial"})
    measure(device, text, frame, machine);
}

}  // namespace
}  // namespace tessera

int main(int count, char** values) try {
  const std::string device = count > 1 ? values[1] : "";
  const int width = count > 3 ? std::atoi(values[2]) : 1280, height = count > 3 ? std::atoi(values[3]) : 720;
  if (width < 1 || height < 1 || width > 16384 || height > 16384) {
    fmt::print(stderr, "usage: filter_bench [device] [width height], each from 1 to 16384\n");
    return static_cast<int>(tessera::ExitCode::bad_usage);
  }
  tessera::run(device, {0, 0, width, height});
} catch (const tessera::Error& e) {
  fmt::print(stderr, "filter_bench: {}\n", e.what());
  return static_cast<int>(e.code());
}
