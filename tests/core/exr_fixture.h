// SPDX-License-Identifier: Apache-2.0
// Tests of EXR files in a folder of their own.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <string>

#include "core/error.h"

namespace tessera {

// A folder of the test's own, removed with it.
class ExrFixture : public testing::Test {
 protected:
  ExrFixture() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("tessera-") + test->name() + std::to_string(std::random_device{}()));
    std::filesystem::create_directories(folder_);
  }
  ~ExrFixture() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path file(const std::string& name = "a.exr") const { return folder_ / name; }
  std::size_t files() const { return std::distance(std::filesystem::directory_iterator(folder_), {}); }

 private:
  std::filesystem::path folder_;
};

inline std::string error_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const InputError& e) {
    return e.what();
  }
  return "no InputError";
}

inline std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace tessera
