// SPDX-License-Identifier: Apache-2.0
#include "cli/denoise.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ostream>
#include <set>

#include "cli/frame_store.h"
#include "cli/picture_options.h"
#include "cli/walk.h"
#include "core/error.h"
#include "core/layers.h"
#include "core/sequence.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// How many pixels of each layer are not finite, and where the first one is: they come out black, or are no
// guide.
std::vector<std::string> broken(const FilterPlan& plan, const Image& input) {
  std::vector<std::string> notices;
  const std::vector<Channel> channels = plan.inputs();
  const Region& r = input.region();
  for (std::size_t k = 0; k < channels.size(); ++k) {
    const auto plane = input.plane(static_cast<int>(k));
    const auto bad = [](float v) { return !std::isfinite(v); };
    const auto count = std::ranges::count_if(plane, bad);
    if (count == 0) continue;
    const auto first = std::ranges::find_if(plane, bad) - plane.begin();
    notices.push_back(fmt::format("{}: {} pixel{} not finite, the first at ({}, {})",
                                  file_channel(channels[k]), count, count == 1 ? " is" : "s are",
                                  r.x0 + first % r.width(), r.y0 + first / r.width()));
  }
  return notices;
}

// RGB. Each way has this frame in it, and lags behind what changes, but in opposite directions: equal weights
// let that cancel, however much of the noise either way has lost.
Image mean_of(const Image& forwards, const Image& backwards) {
  Image mean = planes_of(forwards, 0, 3);
  for (std::size_t i = 0; i < mean.data().size(); ++i)
    mean.data()[i] += (backwards.data()[i] - mean.data()[i]) / 2;
  return mean;
}

class Denoiser {
 public:
  Denoiser(const DenoiseOptions& o, std::ostream& out, std::ostream& problems)
      : o_(o), out_(out), problems_(problems), files_(o), device_(Device::open(o.device)) {}

  const FilterPlan& plan() const { return files_.plan(); }

  void image() {
    const auto begin = Clock::now();
    if (plan().history() > 0) say("a single image: history=on makes no difference");
    const NoisyFrame frame = files_.read(std::nullopt);
    Walk walk(*device_, o_, 1);
    const FilteredFrame filtered = walk.next(frame, 0);
    files_.write(frame, filtered.image);
    report(frame, filtered, begin);
  }

  // Of `wanted` every frame is written; both are ascending, and have what is read for its history besides.
  ExitCode shot(const std::set<int>& wanted, const std::set<int>& forwards, const std::set<int>& backwards) {
    wanted_ = wanted;
    std::optional<FrameStore> behind;
    if (o_.both_ways) {
      behind.emplace(fs::path(o_.output).parent_path());
      Walk walk(*device_, o_, -1);
      for (auto f = backwards.rbegin(); f != backwards.rend(); ++f)
        guarded(walk, *f, [&] { look_back(walk, *f, *behind); });
    }
    Walk walk(*device_, o_, 1);
    for (const int f : forwards) guarded(walk, f, [&] { look_ahead(walk, f, behind ? &*behind : nullptr); });
    return worst_;
  }

 private:
  // A frame that fails is a cut for those that follow, in either direction.
  template <typename Work>
  void guarded(Walk& walk, int number, Work work) {
    if (failed_.contains(number)) return walk.failed(number);
    try {
      work();
    } catch (const Error& e) {
      if (e.code() == ExitCode::bad_usage) throw;
      problems_ << "tessera: frame " << number << ": " << e.what() << '\n';
      failed_.insert(number);
      walk.failed(number);
      if (wanted_.contains(number)) worst_ = e.code();
    }
  }

  void look_back(Walk& walk, int number, FrameStore& behind) {
    const NoisyFrame frame = files_.read(number, true);
    const FilteredFrame filtered = walk.next(frame, number);
    if (wanted_.contains(number)) behind.put(number, planes_of(filtered.image, 0, 3));
    if (!filtered.cut.empty())
      problems_ << fmt::format("tessera: frame {} starts anew, backwards: {}\n", number, filtered.cut);
    for (const std::string& notice : frame.gathered.notices) say(notice);
    complain(frame, frame.gathered.defects);
  }

  void look_ahead(Walk& walk, int number, const FrameStore* behind) {
    const auto begin = Clock::now();
    const NoisyFrame frame = files_.read(number);
    const FilteredFrame filtered = walk.next(frame, number);
    if (!filtered.cut.empty())
      problems_ << fmt::format("tessera: frame {} starts anew: {}\n", number, filtered.cut);
    if (!wanted_.contains(number)) return;
    files_.write(frame, behind ? mean_of(filtered.image, behind->get(number)) : filtered.image);
    report(frame, filtered, begin);
  }

  void report(const NoisyFrame& frame, const FilteredFrame& filtered, Clock::time_point begin) {
    for (const std::string& notice : frame.gathered.notices) say(notice);
    complain(frame, frame.gathered.defects);
    complain(frame, broken(frame.plan, frame.gathered.input));
    if (o_.quiet) return;
    const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    out_ << fmt::format("{}: {} in tiles of {}x{}, {:.2f} s\n", frame.out.string(), to_string(frame.plan),
                        filtered.tile.width, filtered.tile.height, seconds);
  }

  void complain(const NoisyFrame& frame, const std::vector<std::string>& problems) {
    for (const std::string& p : problems) problems_ << "tessera: " << frame.in.string() << ": " << p << '\n';
  }
  // The same for all frames: once is enough.
  void say(const std::string& notice) {
    if (said_.insert(notice).second) problems_ << "tessera: " << notice << '\n';
  }

  const DenoiseOptions& o_;
  std::ostream &out_, &problems_;
  NoisyFiles files_;
  std::unique_ptr<Device> device_;
  std::set<std::string> said_;
  std::set<int> wanted_, failed_;
  ExitCode worst_ = ExitCode::done;
};

// Those of the sequence that are there and at most `reach` frames before one of `wanted`, or behind it.
std::set<int> with_handles(const std::set<int>& wanted, const std::vector<int>& there, int reach,
                           bool before) {
  std::set<int> all = wanted;
  for (const int f : there) {
    const auto next = wanted.lower_bound(f);
    if (before ? next != wanted.end() && *next - f <= reach
               : next != wanted.begin() && f - *std::prev(next) <= reach)
      all.insert(f);
  }
  return all;
}

void check_options(const DenoiseOptions& o, const FilterPlan& plan) {
  const bool sequence = is_pattern(o.input);
  constexpr std::string_view kSequence = "only with an input that has #### or %04d in its name";
  if (!sequence && !o.frames.empty()) refuse_option("--frames", o.frames, kSequence);
  if (sequence && !is_pattern(o.output))
    refuse_option("--output", o.output, "a name with #### or %04d, as the input is a sequence");
  if (o.handles == 0 && !o.both_ways) return;
  const std::string_view option = o.both_ways ? "--both-ways" : "--handles";
  const std::string value = o.both_ways ? "on" : std::to_string(o.handles);
  if (!sequence) refuse_option(option, value, kSequence);
  if (plan.history() == 0)
    refuse_option(option, value,
                  fmt::format("only with a filter that has history=on, which {} has not", plan.name));
}

std::set<int> wanted_frames(const DenoiseOptions& o, const std::vector<int>& there) {
  const std::vector<int> frames = o.frames.empty() ? there : parse_frames(o.frames);
  if (frames.empty())
    throw InputError(o.input, "no file of that pattern is there", "a sequence of EXR files");
  return {frames.begin(), frames.end()};
}

}  // namespace

int denoise(const DenoiseOptions& o, std::ostream& out, std::ostream& problems) {
  Denoiser denoiser(o, out, problems);
  check_options(o, denoiser.plan());
  if (!is_pattern(o.input)) {
    denoiser.image();
    return 0;
  }
  const std::vector<int> there = frames_there(o.input);
  const std::set<int> wanted = wanted_frames(o, there);
  return static_cast<int>(denoiser.shot(wanted, with_handles(wanted, there, o.handles, true),
                                        with_handles(wanted, there, o.handles, false)));
}

}  // namespace tessera
