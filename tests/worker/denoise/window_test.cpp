// SPDX-License-Identifier: Apache-2.0
// The cheap weights of windows (kernels/window.cl) and of the a-trous levels (kernels/geometry.cl).
#include <cmath>
#include <fstream>
#include <sstream>

#include "core/filter/descriptions.h"
#include "tests/worker/denoise/denoise_test.h"
#include "worker/denoise/device_cl.h"
#include "worker/denoise/window.h"

namespace tessera {
namespace {

constexpr float kOne = 127 << 23, kUnit = 1 << 23;  // the exponents of 1, and of an octave

class WindowWeights : public OnDevice {
 protected:
  std::vector<float> of(const std::vector<float>& exponents, const std::string& kernels = "window.cl") {
    ClDevice& cl = dynamic_cast<ClDevice&>(*device_);
    std::ifstream file(TESSERA_SOURCE_DIR "/worker/denoise/kernels/" + kernels);
    std::stringstream source;
    source << file.rdbuf()
           << "kernel void evaluate(global const float* e, global float* w) {"
              "  const int i = get_global_id(1) * VW;"
              "  store(weight_of(load(e + i)), w + i);"
              "}";
    const std::lock_guard lock(cl.mutex());
    std::vector<float> results(exponents.size());
    cl::Program& program = cl.program(source.str(), "-DRADIUS=1 -DPLANES=1 -DSTRIP=128 -DPAD=16 -DPITCH=160");
    cl::Kernel kernel(program, "evaluate");
    cl::Buffer in = cl.borrowed(std::span(exponents)), out = cl.borrowed(std::span(results));
    kernel.setArg(0, in);
    kernel.setArg(1, out);
    cl.run(kernel, 1, static_cast<int>(exponents.size()) / cl.vector_width());
    cl.finish(out, results);
    return results;
  }
  // The largest relative error from 1 down to 2^-126.
  double worst_of(const std::string& kernels) {
    std::vector<float> exponents;
    for (int i = 0; i < 1 << 20; ++i)
      exponents.push_back(kOne - 126.0f * kUnit * static_cast<float>(i) / (1 << 20));
    for (int i = 0; i < 1 << 17; ++i)
      exponents.push_back(kOne - 64.0f * static_cast<float>(i));  // all between 1/2 and 1
    const std::vector<float> weights = of(exponents, kernels);
    double worst = 0;
    for (std::size_t i = 0; i < weights.size(); ++i)
      worst = std::max(worst, std::abs(weights[i] / std::exp2((double(exponents[i]) - kOne) / kUnit) - 1));
    return worst;
  }
};

// Not much less either, as the polynomials' alternating errors are.
TEST_F(WindowWeights, AreAsPreciseAsTheKernelsSay) {
  EXPECT_THAT(worst_of("window.cl"), testing::AllOf(testing::Gt(8e-5), testing::Lt(9e-5)));
  EXPECT_THAT(worst_of("geometry.cl"), testing::AllOf(testing::Gt(3e-6), testing::Lt(4e-6)));
}

TEST_F(WindowWeights, AreExactAtTheEnds) {
  std::vector<float> exponents(16, -INFINITY);
  exponents[0] = kOne;
  exponents[1] = kOne - kUnit;
  exponents[2] = -3e38f;
  exponents[3] = 0;
  exponents[4] = kUnit;
  exponents[5] = NAN;
  for (const char* kernels : {"window.cl", "geometry.cl"}) {
    const std::vector<float> weights = of(exponents, kernels);
    EXPECT_THAT(std::vector(weights.begin(), weights.begin() + 7),
                testing::ElementsAre(1.0f, 0.5f, 0.0f, 0.0f, 0x1p-126f, 0.0f, 0.0f))
        << kernels;
  }
}

// What its description states is enough for every size and vector, a picture that is its own tile among them.
TEST(WindowScratch, IsStated) {
  constexpr int kPlanes = 3;
  for (const int vector : {1, 4, 8, 16})
    for (int radius = 1; radius <= 27; ++radius)
      for (const int width : {1, 2, 8, 14, 26, 40, 127, 128, 129, 200, 1000})
        for (const int height : {1, 30, 600, 2160}) {
          const Layout layout({0, 0, width, height}, radius, vector);
          EXPECT_LE(static_cast<double>(window_floats({width, height}, radius, kPlanes)),
                    window_scratch(kPlanes) * static_cast<double>(layout.plane))
              << width << "x" << height << ", radius " << radius << ", vectors of " << vector;
        }
}

}  // namespace
}  // namespace tessera
