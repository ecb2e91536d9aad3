// SPDX-License-Identifier: Apache-2.0
// What comes as a layered EXR: read, then gathered as a filter's input. Whatever the bytes, the outcome is an
// image or an Error.
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>

#include "core/error.h"
#include "core/exr.h"
#include "core/filter/gather.h"

// A few bytes may stand for a large picture, of which a filter takes dozens of planes: more memory than a
// fuzzer has.
constexpr std::int64_t kMostValues = 1 << 18;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace tessera;
  static const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("tessera-fuzz-" + std::to_string(getpid()) + ".exr");
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  try {
    const ExrImage image = read_exr(file, kMostValues);
    for (const char* filter : {"none", "svgf"}) try {
        gather(parse_filter(filter), {&image, {}, {}}, "fuzzed");
      } catch (const Error&) {
      }
  } catch (const Error&) {
  }
  return 0;
}
