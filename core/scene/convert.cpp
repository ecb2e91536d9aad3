// SPDX-License-Identifier: Apache-2.0
#include "core/scene/convert.h"

#include <fmt/format.h>

#include <fstream>

#include "core/error.h"
#include "core/pending_file.h"
#include "core/scene/files.h"
#include "core/scene/load.h"
#include "core/scene/native/write.h"

namespace tessera {
namespace {

// A file beside the one to be written, with an extension that says what it is.
class Draft {
 public:
  explicit Draft(const std::filesystem::path& target)
      : target_(target), path_(PendingFile(target).temporary()) {
    path_ += ".json";
  }
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;
  ~Draft() {
    std::error_code not_there;
    std::filesystem::remove(path_, not_there);
  }

  void write(const std::string& text) const {
    std::ofstream file(path_, std::ios::binary);
    file << text;
    file.close();
    if (!file)
      throw InputError(target_.string(), "cannot be written", "a name in a folder that can be written");
  }

  // Nothing if it loads as a scene of that hash, or else why not.
  std::string difference(const std::string& hash, const ImportLimits& limits) const {
    try {
      return content_hash(load_scene(path_, limits)) == hash ? ""
                                                             : "it would not read back the same to the bit";
    } catch (const InputError& e) {
      return e.what();
    }
  }

  void publish() const { std::filesystem::rename(path_, target_); }

 private:
  std::filesystem::path target_, path_;
};

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

}  // namespace

Conversion convert_scene(const std::filesystem::path& from, const std::filesystem::path& to,
                         const ImportLimits& limits) {
  if (extension_of(to) != ".json")
    throw Error(ExitCode::bad_usage,
                fmt::format("'{}' is no name of a native scene; accepted: .json", to.string()));
  std::error_code none;
  if (std::filesystem::equivalent(from, to, none))
    throw Error(ExitCode::bad_usage, "the scene cannot be converted onto itself");
  Conversion conversion{load_scene(from, limits)};
  const std::string hash = content_hash(conversion.scene);
  const Draft draft(to);
  if (const auto obstacle = obstacle_to_inline(conversion.scene)) {
    conversion.why_not = *obstacle;
  } else {
    draft.write(whole_scene_text(conversion.scene, folder_of(to)));
    conversion.why_not = draft.difference(hash, limits);
  }
  conversion.whole = conversion.why_not.empty();
  if (!conversion.whole) {
    draft.write(importing_text(conversion.scene, from, folder_of(to)));
    if (const std::string difference = draft.difference(hash, limits); !difference.empty())
      throw InputError(from.string(), "cannot be converted: " + difference);
  }
  draft.publish();
  return conversion;
}

}  // namespace tessera
