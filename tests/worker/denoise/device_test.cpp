// SPDX-License-Identifier: Apache-2.0
#include "worker/denoise/device.h"

#include <cmath>

#include "core/error.h"
#include "tests/worker/denoise/denoise_test.h"
#include "worker/denoise/device_cl.h"

namespace tessera {
namespace {

class Devices : public OnDevice {
 protected:
  ClDevice& cl() { return dynamic_cast<ClDevice&>(*device_); }

  std::vector<float> powers_of_two(const std::vector<float>& exponents) {
    const std::lock_guard lock(cl().mutex());
    std::vector<float> results(exponents.size());
    cl::Program& program = cl().program(
        "kernel void evaluate(global const float* t, global float* e) {"
        "  const int i = get_global_id(1) * VW;"
        "  store(exp2_of_negative(load(t + i)), e + i);"
        "}");
    cl::Kernel kernel(program, "evaluate");
    cl::Buffer in = cl().borrowed(std::span(exponents)), out = cl().borrowed(std::span(results));
    kernel.setArg(0, in);
    kernel.setArg(1, out);
    cl().run(kernel, 1, static_cast<int>(exponents.size()) / cl().vector_width());
    cl().finish(out, results);
    return results;
  }
};

TEST_F(Devices, AreFoundByIndexAndByAPartOfTheName) {
  const auto all = list_devices();
  EXPECT_EQ(Device::open("0")->info().name, all[0].name);
  std::string name = all[0].name.substr(1);
  for (char& c : name) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  EXPECT_EQ(Device::open(name)->info().name, all[0].name);
  EXPECT_GT(all[0].compute_units, 0);
  EXPECT_GT(all[0].memory, 0u);
}

TEST_F(Devices, ThatDoNotExistAreAnsweredWithThoseThatDo) {
  for (const std::string which : {"no such device", "999", "-1", "99999999999999999999999"}) try {
      Device::open(which);
      ADD_FAILURE() << which;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::no_device);
      EXPECT_THAT(e.what(), testing::HasSubstr("'" + which + "'"));
      EXPECT_THAT(e.what(), testing::HasSubstr(list_devices()[0].name));
    }
}

TEST_F(Devices, SayWhatIsWrongWithAProgram) {
  const std::lock_guard lock(cl().mutex());
  for (int attempt = 0; attempt < 2; ++attempt) try {
      cl().program("kernel void broken() { undeclared_name = 1; }");
      ADD_FAILURE();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::internal_error);
      EXPECT_THAT(e.what(), testing::HasSubstr("undeclared_name"));
    }
}

TEST_F(Devices, BuildAProgramOnce) {
  const std::lock_guard lock(cl().mutex());
  const cl::Program* first = &cl().program("kernel void a() {}");
  EXPECT_EQ(&cl().program("kernel void a() {}"), first);
  EXPECT_NE(&cl().program("kernel void a() {}", "-DX"), first);
}

TEST_F(Devices, ComputePowersOfTwoAsPreciselyAsTheKernelsSay) {
  std::vector<float> exponents;
  for (int i = 0; i < 1 << 18; ++i) exponents.push_back(-126.0f * static_cast<float>(i) / (1 << 18));
  for (int i = 0; i < 1 << 10; ++i) exponents.push_back(-std::ldexp(1.0f, -i / 8) * (1 + (i % 8) / 8.0f));
  const std::vector<float> results = powers_of_two(exponents);
  double worst = 0;
  for (std::size_t i = 0; i < results.size(); ++i)
    worst = std::max(worst, std::abs(results[i] / std::exp2(double(exponents[i])) - 1));
  EXPECT_LT(worst, 3e-7);
  RecordProperty("worst", std::to_string(worst));
}

TEST_F(Devices, ComputeExactPowersOfTwoAtTheEnds) {
  std::vector<float> exponents(16, -200.0f);
  exponents[0] = 0.0f;
  exponents[1] = -0.0f;
  exponents[2] = -INFINITY;
  exponents[3] = -126.6f;
  exponents[4] = -3e38f;
  exponents[5] = -1.0f;
  exponents[6] = -126.0f;
  const std::vector<float> results = powers_of_two(exponents);
  EXPECT_THAT(std::vector(results.begin(), results.begin() + 8),
              testing::ElementsAre(1.0f, 1.0f, 0.0f, 0.0f, 0.0f, 0.5f, 0x1p-126f, 0.0f));
}

}  // namespace
}  // namespace tessera
