// SPDX-License-Identifier: Apache-2.0
#include "core/sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <set>

#include "core/error.h"

namespace tessera {
namespace {

constexpr int kFarthest = 999'999;
constexpr std::string_view kAccepted = "ranges such as 1-10, 1-100x2 or 7, separated by commas";

[[noreturn]] void refuse(std::string_view part, std::string_view why, std::string_view accepted = kAccepted) {
  throw Error(ExitCode::bad_usage,
              fmt::format("frames: '{}' {}; accepted: {}", part.substr(0, 64), why, accepted));
}

// Takes a whole number from the front of `rest`.
int number(std::string_view& rest, std::string_view part) {
  int value = 0;
  const auto [end, problem] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
  if (problem != std::errc{} || value < -kFarthest || value > kFarthest)
    refuse(part, fmt::format("has no number from {} to {} where one is due", -kFarthest, kFarthest));
  rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
  return value;
}

struct Range {
  int first = 0, last = 0, step = 1;
};

Range parse_range(std::string_view part) {
  std::string_view rest = part;
  Range r;
  r.first = r.last = number(rest, part);
  if (rest.starts_with('-')) {
    rest.remove_prefix(1);
    r.last = number(rest, part);
    if (rest.starts_with('x')) {
      rest.remove_prefix(1);
      r.step = number(rest, part);
    }
  }
  if (!rest.empty()) refuse(part, "goes on after its end");
  if (r.step < 1) refuse(part, "has a step below 1");
  if (r.last < r.first) refuse(part, "ends before it begins");
  return r;
}

// Where a frame number stands in a file name, and its least digits.
struct NumberPlace {
  std::size_t begin = 0, size = 0;
  int digits = 1;
};

std::optional<NumberPlace> place_in(std::string_view name) {
  std::optional<NumberPlace> found;
  const auto take = [&](NumberPlace p) {
    if (found) return false;  // two places: no pattern
    found = p;
    return true;
  };
  for (std::size_t i = 0; i < name.size();) {
    std::size_t size = 1;
    if (name[i] == '#') {
      while (i + size < name.size() && name[i + size] == '#') ++size;
      if (!take({i, size, static_cast<int>(std::min<std::size_t>(size, 9))})) return std::nullopt;
    } else if (name[i] == '%') {
      int digits = 1;
      if (i + 2 < name.size() && name[i + 1] == '0' && name[i + 2] >= '1' && name[i + 2] <= '9') {
        digits = name[i + 2] - '0';
        size = 3;
      }
      if (i + size >= name.size() || name[i + size] != 'd' || !take({i, size + 1, digits}))
        return std::nullopt;
      ++size;
    }
    i += size;
  }
  return found;
}

}  // namespace

std::vector<int> parse_frames(std::string_view text) {
  std::vector<int> frames;
  std::set<int> seen;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string_view part = text.substr(begin, end - begin);
    const Range r = parse_range(part);
    for (int f = r.first; f <= r.last; f += r.step) {
      if (frames.size() >= kMaxFrames)
        refuse(part, "leads to too many frames", fmt::format("at most {} frames", kMaxFrames));
      if (seen.insert(f).second) frames.push_back(f);
    }
    begin = end + 1;
  }
  return frames;
}

std::string ranges_of(const std::vector<int>& frames) {
  std::vector<std::string> ranges;
  for (std::size_t i = 0; i < frames.size();) {
    std::size_t end = i + 1;
    while (end < frames.size() && frames[end] == frames[end - 1] + 1) ++end;
    ranges.push_back(end == i + 1 ? fmt::format("{}", frames[i])
                                  : fmt::format("{}-{}", frames[i], frames[end - 1]));
    i = end;
  }
  return fmt::format("{}", fmt::join(ranges, ", "));
}

bool is_pattern(const std::filesystem::path& file) { return place_in(file.filename().native()).has_value(); }

std::filesystem::path beside(const std::filesystem::path& pattern, std::string_view text) {
  std::string name = pattern.filename().native();
  const NumberPlace place = place_in(name).value();
  name.replace(place.begin, place.size, text);
  return std::filesystem::path(pattern).replace_filename(name);
}

std::filesystem::path file_of(const std::filesystem::path& pattern, int frame) {
  const NumberPlace place = place_in(pattern.filename().native()).value();
  return beside(pattern, fmt::format("{}{:0{}d}", frame < 0 ? "-" : "", std::abs(frame), place.digits));
}

std::vector<int> frames_there(const std::filesystem::path& pattern) {
  const std::string name = pattern.filename().native();
  const NumberPlace place = place_in(name).value();
  const std::string_view front = std::string_view(name).substr(0, place.begin);
  const std::string_view back = std::string_view(name).substr(place.begin + place.size);
  const std::filesystem::path folder = pattern.has_parent_path() ? pattern.parent_path() : ".";
  std::error_code problem;
  std::set<int> frames;
  for (const auto& entry : std::filesystem::directory_iterator(folder, problem)) {
    const std::string file = entry.path().filename().native();
    if (file.size() <= front.size() + back.size() || !file.starts_with(front) || !file.ends_with(back))
      continue;
    const std::string_view digits =
        std::string_view(file).substr(front.size(), file.size() - front.size() - back.size());
    int frame = 0;
    const auto [end, bad] = std::from_chars(digits.data(), digits.data() + digits.size(), frame);
    if (bad != std::errc{} || end != digits.data() + digits.size() || std::abs(frame) > kFarthest) continue;
    if (file_of(pattern, frame).filename() == file) frames.insert(frame);
  }
  if (problem) throw InputError(folder.string(), problem.message(), "a folder that can be read");
  return {frames.begin(), frames.end()};
}

}  // namespace tessera
