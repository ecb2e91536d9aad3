// SPDX-License-Identifier: Apache-2.0
// Runs `tessera denoise` on files in a folder of its own.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <random>
#include <sstream>

#include "cli/denoise.h"
#include "core/error.h"
#include "core/exr.h"
#include "worker/denoise/device.h"

namespace tessera {

class DenoiseFixture : public testing::Test {
 protected:
  void SetUp() override {
    if (list_devices().empty()) GTEST_SKIP() << "no OpenCL device on this machine";
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("tessera-denoise" + std::to_string(std::random_device{}()));
    std::filesystem::create_directories(folder_);
  }
  ~DenoiseFixture() override {
    if (!folder_.empty()) std::filesystem::remove_all(folder_);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  void write(const std::string& name, const ExrImage& image) const { write_exr(path(name), image); }

  int run(const DenoiseOptions& options) {
    std::ostringstream out, problems;
    const int code = denoise(options, out, problems);
    out_ = out.str();
    problems_ = problems.str();
    return code;
  }
  DenoiseOptions options(const std::string& input, const std::string& output) const {
    DenoiseOptions o;
    o.input = path(input);
    o.output = path(output);
    o.filter = "atrous:levels=2";
    return o;
  }
  Error error_of(const DenoiseOptions& o) {
    try {
      run(o);
    } catch (const Error& e) {
      return e;
    }
    return Error(ExitCode::done, "no error");
  }

  std::filesystem::path folder_;
  std::string out_, problems_;
};

}  // namespace tessera
