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

constexpr const char* kKey = "tessera/job";

// The key in a file that can be read to its end; empty: there is none.
std::string key_in(const ExrImage& file) {
  const auto key = file.metadata.find(kKey);
  const auto* text = key == file.metadata.end() ? nullptr : std::get_if<std::string>(&key->second);
  return text == nullptr ? "" : *text;
}
std::string key_of(const fs::path& file) {
  try {
    return fs::exists(file) ? key_in(read_exr(file)) : "";
  } catch (const Error&) {
    return "";
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

bool FrameFiles::holds(int number, const std::string& key) const { return key_of(frame(number)) == key; }

fs::path FrameFiles::history() const { return beside(output_, "history"); }

void FrameFiles::keep(const Image& kept, const std::string& key) const {
  if (!is_pattern(output_)) return;
  ExrImage file;
  file.display = kept.region();
  file.pixels = kept;
  for (int p = 0; p < kept.planes(); ++p) file.channels.push_back({fmt::format("history.{:03}", p), false});
  file.metadata[kKey] = key;
  write_exr(history(), file, "none");
}

std::string FrameFiles::kept_key() const { return is_pattern(output_) ? key_of(history()) : ""; }

std::shared_ptr<const Image> FrameFiles::kept(const std::string& key, const Job& next) const {
  ExrImage file = read_exr(history());
  const bool fits = key_in(file) == key && file.pixels.region() == next.region() &&
                    file.pixels.planes() == history_planes(next.filter);
  return fits ? std::make_shared<const Image>(std::move(file.pixels)) : nullptr;
}

}  // namespace tessera
