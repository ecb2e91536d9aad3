// SPDX-License-Identifier: Apache-2.0
#include "cli/frame_files.h"

#include <fmt/format.h>
#include <unistd.h>

#include "core/error.h"
#include "core/exr.h"
#include "core/filter/history.h"
#include "core/sequence.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr const char *kImage = "tessera/job", *kHistory = "tessera/history";

// Of a file that can be read to its end.
std::optional<ExrImage> read_whole(const fs::path& file) {
  try {
    return fs::exists(file) ? std::optional(read_exr(file)) : std::nullopt;
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

FrameFiles::FrameFiles(fs::path output, bool many) : output_(std::move(output)) {
  const auto refuse = [&](const std::string& why) {
    throw Error(ExitCode::bad_usage, fmt::format("--output: {}", why));
  };
  if (output_.extension() != ".exr")
    refuse(fmt::format("'{}' is not accepted; accepted: a name ending in .exr", output_.string()));
  if (many && !is_pattern(output_))
    refuse(fmt::format("'{}' has no place for frame numbers; accepted: a name such as shot.####.exr",
                       output_.string()));
  const fs::path folder = output_.has_parent_path() ? output_.parent_path() : ".";
  if (!fs::is_directory(folder)) refuse(fmt::format("there is no folder '{}'", folder.string()));
  if (access(folder.c_str(), W_OK) != 0) refuse(fmt::format("cannot write into '{}'", folder.string()));
}

fs::path FrameFiles::frame(int number) const {
  return is_pattern(output_) ? file_of(output_, number) : output_;
}

bool FrameFiles::holds(int number, const std::string& key) const {
  const auto file = read_whole(frame(number));
  const std::string* held = file ? file->about<std::string>(kImage) : nullptr;
  return held != nullptr && *held == key;
}

fs::path FrameFiles::history() const { return beside(output_, "history"); }

void FrameFiles::keep(const Kept& kept) const {
  if (!is_pattern(output_)) return;
  ExrImage file;
  file.display = kept.planes->region();
  file.pixels = *kept.planes;
  for (int p = 0; p < kept.planes->planes(); ++p)
    file.channels.push_back({fmt::format("history.{:03}", p), ExrType::float32});
  file.metadata[kHistory] = kept.key;
  write_exr(history(), file, "none");
}

std::optional<Kept> FrameFiles::kept(const Job& like) const {
  auto file = is_pattern(output_) ? read_whole(history()) : std::nullopt;
  const std::string* key = file ? file->about<std::string>(kHistory) : nullptr;
  if (key == nullptr || file->pixels.region() != like.region() ||
      file->pixels.planes() != history_planes(like.filter))
    return std::nullopt;
  return Kept{*key, std::make_shared<const Image>(std::move(file->pixels))};
}

}  // namespace tessera
