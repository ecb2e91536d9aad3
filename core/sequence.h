// SPDX-License-Identifier: Apache-2.0
// Frames of a shot: ranges of frame numbers as users write them, and file names with a place for the number.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

inline constexpr int kMaxFrames = 100'000;  // of one job: the coordinator keeps a record of each

// "1-10x2,15": ranges with an optional step, and single numbers, in the order given, each once. At most
// kMaxFrames; numbers from -999999 to 999999; "-5--1" counts from -5 to -1. Throws Error(bad_usage) that says
// where it goes wrong.
std::vector<int> parse_frames(std::string_view text);

// "1-3, 7": ascending numbers for people.
std::string ranges_of(const std::vector<int>& frames);

// True for "shot.####.exr" and "shot.%04d.exr": a name with one place for a frame number.
bool is_pattern(const std::filesystem::path& file);

// The file of a frame: '#'s count the least digits, %d and %0Nd are as in C. Precondition:
// is_pattern(pattern).
std::filesystem::path file_of(const std::filesystem::path& pattern, int frame);

// The file of that name beside a pattern's frames: "shot.history.exr" for "history" and "shot.####.exr".
// Precondition: is_pattern(pattern).
std::filesystem::path beside(const std::filesystem::path& pattern, std::string_view name);

// The frames whose files are there, ascending. Throws InputError if the folder cannot be read.
std::vector<int> frames_there(const std::filesystem::path& pattern);

}  // namespace tessera
