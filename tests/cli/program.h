// SPDX-License-Identifier: Apache-2.0
// The program run as people run it, in a folder of its own.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>

#include "worker/denoise/device.h"

namespace tessera {

namespace fs = std::filesystem;

struct Outcome {
  int code = -1;
  std::string text;  // stdout and stderr
};

// Runs the program; calls `each_line` as its lines come, with its process id.
inline Outcome run(const std::vector<std::string>& arguments,
                   const std::function<void(pid_t, const std::string&)>& each_line = {}) {
  int ends[2];
  if (pipe(ends) != 0) return {};
  const pid_t child = fork();
  if (child == 0) {
    dup2(ends[1], STDOUT_FILENO);
    dup2(ends[1], STDERR_FILENO);
    close(ends[0]);
    std::vector<char*> argv{const_cast<char*>(TESSERA_BINARY)};
    for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
    argv.push_back(nullptr);
    execv(TESSERA_BINARY, argv.data());
    _exit(127);
  }
  close(ends[1]);
  Outcome outcome;
  std::string line;
  for (char c = 0; read(ends[0], &c, 1) == 1;) {
    outcome.text += c;
    if (c != '\n') {
      line += c;
      continue;
    }
    if (each_line) each_line(child, line);
    line.clear();
  }
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return outcome;
}

class Program : public ::testing::Test {
 protected:
  void SetUp() override {
    if (list_devices().empty()) GTEST_SKIP() << "no OpenCL device on this machine";
    folder_ = fs::path(::testing::TempDir()) / ("tessera-cli-" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override {
    if (!folder_.empty()) fs::remove_all(folder_);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return path(name);
  }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  // A render of a bad scene: exit code 3, `what` in the message, and no file that was not there before.
  void expect_bad_input(const std::string& scene, const std::string& what) const {
    const std::size_t before = files();
    const Outcome outcome = run({"render", scene, "-o", path("out.exr"), "--width", "16", "--height", "16"});
    EXPECT_EQ(outcome.code, 3) << outcome.text;
    EXPECT_THAT(outcome.text, ::testing::HasSubstr(what));
    EXPECT_EQ(files(), before) << "a failed render leaves nothing behind";
  }

  const std::string furnace_ = std::string(TESSERA_SOURCE_DIR) + "/scenes/furnace.json";
  const std::string cornell_ = std::string(TESSERA_SOURCE_DIR) + "/scenes/cornell.json";
  fs::path folder_;
};

}  // namespace tessera
