// SPDX-License-Identifier: Apache-2.0
#include "cli/denoise.h"

#include <chrono>

#include "cli/both_ways.h"
#include "cli/denoise_farm.h"
#include "cli/denoise_frames.h"
#include "cli/denoise_words.h"
#include "cli/frame_store.h"
#include "cli/walk.h"
#include "cli/worse.h"
#include "core/error.h"
#include "core/sequence.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// On this machine.
class Denoiser {
 public:
  Denoiser(const DenoiseOptions& o, const NoisyFiles& files, DenoiseWords& words)
      : o_(o), files_(files), words_(words), device_(Device::open(o.device)) {}

  void image() {
    const auto begin = Clock::now();
    const NoisyFrame frame = files_.read(std::nullopt);
    Walk walk(*device_, o_, 1);
    const FilteredFrame filtered = walk.next(frame, 0);
    files_.write(frame, planes_of(filtered.image, 0, 3));
    report(frame, filtered, begin);
  }

  ExitCode shot(const DenoiseFrames& frames) {
    wanted_ = frames.wanted;
    std::optional<FrameStore> behind;
    if (o_.both_ways) {
      behind.emplace(fs::path(o_.output).parent_path());
      Walk walk(*device_, o_, -1);
      for (auto f = frames.backwards.rbegin(); f != frames.backwards.rend(); ++f)
        guarded(walk, *f, [&] { look_back(walk, *f, *behind); });
    }
    Walk walk(*device_, o_, 1);
    for (const int f : frames.forwards)
      guarded(walk, f, [&] { look_ahead(walk, f, behind ? &*behind : nullptr); });
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
      words_.failed(number, e.what());
      failed_.insert(number);
      walk.failed(number);
      if (wanted_.contains(number)) worst_ = worse(worst_, e.code());
    }
  }

  void look_back(Walk& walk, int number, FrameStore& behind) {
    const NoisyFrame frame = files_.read(number, true);
    const FilteredFrame filtered = walk.next(frame, number);
    if (wanted_.contains(number)) behind.put(number, planes_of(filtered.image, 0, 3));
    if (!filtered.cut.empty()) words_.starts_anew(number, true, filtered.cut);
    words_.notices(frame, false);
  }

  void look_ahead(Walk& walk, int number, const FrameStore* behind) {
    const auto begin = Clock::now();
    const NoisyFrame frame = files_.read(number);
    const FilteredFrame filtered = walk.next(frame, number);
    if (!filtered.cut.empty()) words_.starts_anew(number, false, filtered.cut);
    if (!wanted_.contains(number)) return;
    const Image rgb = planes_of(filtered.image, 0, 3);
    files_.write(frame, behind ? mean_of_ways(rgb, behind->get(number)) : rgb);
    report(frame, filtered, begin);
  }

  void report(const NoisyFrame& frame, const FilteredFrame& filtered, Clock::time_point begin) {
    words_.notices(frame, true);
    words_.done(frame, filtered.tile, "", std::chrono::duration<double>(Clock::now() - begin).count());
  }

  const DenoiseOptions& o_;
  const NoisyFiles& files_;
  DenoiseWords& words_;
  std::unique_ptr<Device> device_;
  std::set<int> wanted_, failed_;
  ExitCode worst_ = ExitCode::done;
};

}  // namespace

int denoise(const DenoiseOptions& o, std::ostream& out, std::ostream& problems) {
  NoisyFiles files(o);
  check_options(o, files.plan());
  DenoiseWords words(out, problems, o.quiet);
  const bool sequence = is_pattern(o.input);
  if (!sequence && files.plan().history() > 0) words.say("a single image: history=on makes no difference");
  if (sequence) files.take_facts_of(frames_there(o.input));
  if (!o.farm.coordinator.empty()) return static_cast<int>(denoise_on_farm(o, files, words));
  Denoiser denoiser(o, files, words);
  if (sequence) return static_cast<int>(denoiser.shot(frames_of(o)));
  denoiser.image();
  return 0;
}

}  // namespace tessera
