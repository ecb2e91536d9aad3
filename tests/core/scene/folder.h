// SPDX-License-Identifier: Apache-2.0
// A folder of files made for one test, gone after it.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "core/error.h"
#include "core/scene/load.h"

namespace tessera {

inline const std::filesystem::path kData = std::filesystem::path(TESSERA_SOURCE_DIR) / "tests/data/scene";

inline std::string contents(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class Folder {
 public:
  Folder()
      : path_(std::filesystem::temp_directory_path() / ("tessera-scene-test-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path_ / name, std::ios::binary) << bytes;
    return path_ / name;
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// What loading `file` is refused with, from the file's name on; "loaded" if it is not refused.
inline std::string refusal(const std::filesystem::path& file) {
  try {
    load_scene(file);
  } catch (const InputError& e) {
    EXPECT_EQ(e.code(), ExitCode::bad_input);
    const std::string text = e.what(), folder = file.parent_path().string() + "/";
    return text.starts_with(folder) ? text.substr(folder.size()) : text;
  }
  return "loaded";
}

}  // namespace tessera
