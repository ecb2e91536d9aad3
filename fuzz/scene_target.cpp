// SPDX-License-Identifier: Apache-2.0
// The bytes are a scene file of the format TESSERA_FORMAT: it loads, or is refused with an InputError.
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "core/error.h"
#include "core/scene/load.h"

namespace {

namespace fs = std::filesystem;

// A folder of this process, with files for the bytes to refer to.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("tessera-fuzz-" + std::to_string(getpid()))) {
    fs::create_directories(path_);
    for (const char* name : {"corners.png", "card.mtl", "card.obj", "card.gltf"})
      fs::copy_file(fs::path(TESSERA_BESIDE) / name, path_ / name, fs::copy_options::overwrite_existing);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  fs::path input() const { return path_ / "input." TESSERA_FORMAT; }

 private:
  fs::path path_;
};

// What a machine of the farm could be asked to allow, small enough for many runs a second.
constexpr tessera::ImportLimits kLimits{1 << 20, 1 << 20, 1 << 20, 1 << 16, 1 << 22, 4};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Folder folder;
  std::ofstream(folder.input(), std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    const tessera::Scene scene = tessera::load_scene(folder.input(), kLimits);
    tessera::content_hash(scene);
  } catch (const tessera::InputError&) {
  }
  return 0;
}
