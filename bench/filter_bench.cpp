// SPDX-License-Identifier: Apache-2.0
// How fast the filters' kernels are, in milliseconds and as a fraction of what this machine can do: its peak
// of fused multiply-adds and its bandwidth are measured in the same run, on the same device.
//   filter_bench [--device=NAME] [WIDTHxHEIGHT] [FILTER ...]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <map>
#include <random>

#include "core/error.h"
#include "worker/denoise/device_cl.h"
#include "worker/denoise/runner.h"

namespace tessera {
namespace {

constexpr int kRuns = 25;
constexpr int kFewRuns = 3;        // of a filter that takes longer than
constexpr double kLongRun = 0.25;  // seconds
constexpr std::string_view kTexts[] = {
    "atrous",
    "atrous:history=on",
    "bilateral",
    "bmfr",
    "bmfr:grids=1",
    "bmfr:history=on",
    "bmfr:history=on,taa=on",
    "bmfr:regularisation=stochastic",
    "box",
    "cross-bilateral",
    "fdf",
    "ddf",
    "ddf:holes=on",
    "ddf:kw=55",
    "gaussian",
    "guided",
    "nfor",
    "nlm",
    "nlm:mode=prefilter",
    "rhf",
    "rhf:average=patches,bins=shared",
    "rhf:patch=0",
    "rhf:scales=2",
    "rpf",
    "rdfc",
    "sbf",
    "statmc",
    "sure-atrous",
    "sure-atrous:edge=svgf",
    "sure-atrous:mode=literal",
    "svgf",
    "svgf:history=on",
    "svgf:history=on,variance=spatial",
    "svgf:variance=spatial",
};
constexpr double kMostFlops = 1e12;  // of a call: slower filters get a smaller picture
constexpr int kPeakRuns = 100;       // short ones: the best falls between other programs' turns

// Surfaces with noise, such that every weight is exercised.
Image noisy_input(const FilterPlan& plan, const Region& frame) {
  const std::vector<Channel> inputs = plan.inputs();
  Image image(frame, static_cast<int>(inputs.size()));
  std::minstd_rand random(1);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (int k = 0; k < image.planes(); ++k)
    for (int y = frame.y0; y < frame.y1; ++y)
      for (int x = frame.x0; x < frame.x1; ++x) {
        const float u = uniform(random);
        const Channel& c = inputs[k];
        float v = c.statistic == Statistic::variance_of_mean ? 0.05f * u : u;
        if (c.statistic == Statistic::samples) v = 8;
        if (c.aov == Aov::normal) v = c.index == 2 ? 1.0f : 0.05f * u;
        if (c.aov == Aov::position) v = 0.01f * (c.index == 0 ? x : c.index == 1 ? y : u);
        if (c.aov == Aov::depth || c.aov == Aov::previous_depth) v = 5 + 0.001f * x + 0.001f * u;
        if (c.aov == Aov::depth_gradient) v = c.index == 0 ? 0.001f : 0.0f;
        if (c.aov == Aov::geometric_normal) v = c.index == 2 ? 1.0f : 0.0f;
        if (c.aov == Aov::object_id || c.aov == Aov::material_id) v = 1;
        // A camera that pans and comes nearer.
        if (c.aov == Aov::motion) v = c.index == 0 ? 2.3f + 0.004f * (x - 640) : 0.7f + 0.004f * (y - 360);
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

// One kernel of a filter: all its runs of one step, in one call of the filter.
struct Row {
  std::string_view kernel;
  int step = 0;                  // 0: not told apart
  double flops = 0, floats = 0;  // of a pixel
  std::vector<double> seconds;   // of each call
};

void print(std::string_view filter, Row row, double pixels, const Machine& machine) {
  std::ranges::sort(row.seconds);
  const double fastest = row.seconds.front(), median = row.seconds[row.seconds.size() / 2];
  fmt::print("{:<24}{:<24}{:>4}  {:>7.2f}  {:>7.2f}", filter, row.kernel,
             row.step ? std::to_string(row.step) : "", 1e3 * fastest, 1e3 * median);
  if (row.flops > 0) {
    const double flops = row.flops * pixels, bytes = sizeof(float) * row.floats * pixels;
    const double least = std::max(flops / machine.flops, bytes / machine.bytes);
    fmt::print("  {:>6.2f}  {:>6.1f}  {:>6.0f} %  {:>7.0f} %  {:>6.0f} %", 1e-9 * flops, 1e-6 * bytes,
               100 * flops / fastest / machine.flops, 100 * bytes / fastest / machine.bytes,
               100 * least / fastest);
  }
  fmt::print("\n");
}

// The kernels in the order in which they ran first. A kernel that runs once for each of its passes is told
// apart by their steps; else its runs, and the costs of its passes, are added up.
std::vector<Row> rows_of(const std::vector<Pass>& passes, const std::vector<KernelTime>& times) {
  std::vector<Row> rows;
  for (const KernelTime& t : times) {
    const auto is_kernel = [&](const auto& other) { return other.kernel == t.kernel; };
    const auto runs = std::ranges::count_if(times, is_kernel),
               stated = std::ranges::count_if(passes, is_kernel);
    const auto before = std::ranges::count_if(rows, is_kernel);
    if (before == 0 || (stated > 1 && runs == stated)) {
      Row row{.kernel = t.kernel};
      int seen = 0;
      for (const Pass& p : passes) {
        if (p.kernel != t.kernel) continue;
        if (runs == stated && seen++ != before) continue;
        row.step = runs == stated && stated > 1 ? p.step : 0;
        row.flops += p.flops;
        row.floats += p.floats;
      }
      rows.push_back(row);
    }
  }
  return rows;
}

void add_times(std::vector<Row>& rows, const std::vector<KernelTime>& times) {
  for (Row& r : rows) r.seconds.push_back(0);
  std::map<std::string_view, std::size_t> seen;
  for (const KernelTime& t : times) {
    const std::size_t nth = seen[t.kernel]++;
    std::vector<Row*> own;
    for (Row& r : rows)
      if (r.kernel == t.kernel) own.push_back(&r);
    own[std::min(nth, own.size() - 1)]->seconds.back() += t.seconds;
  }
}

// The frame, or as much of it as a call of the filter may take.
Region measured(const FilterPlan& plan, const Region& frame) {
  double flops = 0;
  for (const Pass& p : plan.passes()) flops += p.flops;
  const double pixels = kMostFlops / std::max(flops, 1.0);
  if (pixels >= static_cast<double>(frame.area())) return frame;
  const double edge = std::sqrt(pixels / static_cast<double>(frame.area()));
  const auto cut = [&](int v) { return std::max(1, static_cast<int>(edge * v)); };
  return {0, 0, cut(frame.width()), cut(frame.height())};
}

// What is kept after some frames, or nothing.
Image long_history(ClDevice& device, const FilterPlan& plan, const Image& input) {
  constexpr int kFrames = 6;
  const Region& frame = input.region();
  Image history;
  for (int k = 0; k < kFrames && plan.history() > 0; ++k) {
    const Image output = filter(device, plan, input, {frame, frame}, frame, history);
    history = Image(frame, plan.history());
    for (int p = 0; p < plan.history(); ++p) std::ranges::copy(output.plane(3 + p), history.plane(p).begin());
  }
  return history;
}

void measure(ClDevice& device, std::string_view text, const Region& asked, const Machine& machine) {
  const FilterPlan plan = resolved(parse_filter(text), {});
  const Region frame = measured(plan, asked);
  if (frame != asked) fmt::print("{} over {}x{}\n", text, frame.width(), frame.height());
  const Image input = noisy_input(plan, frame);
  const Image history = long_history(device, plan, input);
  std::vector<KernelTime> times;
  device.record(&times);
  recycle(device, filter(device, plan, input, {frame, frame}, frame, history));
  const std::vector<KernelTime> first = times;  // the rows view its names
  std::vector<Row> rows = rows_of(plan.passes(), first);
  Row whole{.kernel = "whole filter"};
  const std::clock_t cpu = std::clock();
  for (int i = 0; i < kRuns && (i < kFewRuns || whole.seconds.front() < kLongRun); ++i) {
    times.clear();
    const auto begin = std::chrono::steady_clock::now();
    recycle(device, filter(device, plan, input, {frame, frame}, frame, history));
    whole.seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    add_times(rows, times);
  }
  const double processor = static_cast<double>(std::clock() - cpu);
  device.record(nullptr);
  const double pixels = static_cast<double>(frame.area());
  for (const Row& row : rows) print(text, row, pixels, machine);
  for (const Pass& p : plan.passes()) whole.flops += p.flops, whole.floats += p.floats;
  const double calls = static_cast<double>(whole.seconds.size());
  print(text, whole, pixels, machine);
  fmt::print("{:<24}{:<24}{:>4}  {:>16.2f}\n", text, "processor time / units", "",
             1e3 * processor / CLOCKS_PER_SEC / calls / device.info().compute_units);
}

void run(const std::string& name, const Region& frame, const std::vector<std::string_view>& texts) {
  const auto opened = Device::open(name);
  ClDevice& device = dynamic_cast<ClDevice&>(*opened);
  const Machine machine{peak_flops(device), bandwidth(device)};
  fmt::print("{}: vectors of {}, {:.0f} Gflop/s, {:.1f} GB/s; {}x{}, {} runs\n\n", device.info().name,
             device.vector_width(), 1e-9 * machine.flops, 1e-9 * machine.bytes, frame.width(), frame.height(),
             kRuns);
  fmt::print("{:<24}{:<24}{:>4}  {:>7}  {:>7}  {:>6}  {:>6}  {:>8}  {:>9}  {:>8}\n", "filter", "kernel",
             "step", "best ms", "median", "Gflop", "MB", "of flops", "of memory", "of roof");
  for (const std::string_view text : texts) measure(device, text, frame, machine);
}

}  // namespace
}  // namespace tessera

int main(int count, char** values) try {
  int width = 1280, height = 720;
  std::string device;
  std::vector<std::string_view> texts;
  for (int i = 1; i < count; ++i) {
    const std::string_view value = values[i];
    if (value.starts_with("--device=")) {
      device = value.substr(9);
    } else if (std::sscanf(values[i], "%dx%d", &width, &height) == 2) {
      if (width < 1 || height < 1 || width > 16384 || height > 16384) {
        fmt::print(stderr, "filter_bench: {} is no size; accepted: WxH, each from 1 to 16384\n", value);
        return static_cast<int>(tessera::ExitCode::bad_usage);
      }
    } else {
      texts.push_back(value);
    }
  }
  if (texts.empty()) texts.assign(std::begin(tessera::kTexts), std::end(tessera::kTexts));
  tessera::run(device, {0, 0, width, height}, texts);
} catch (const tessera::Error& e) {
  fmt::print(stderr, "filter_bench: {}\n", e.what());
  return static_cast<int>(e.code());
}
