// SPDX-License-Identifier: Apache-2.0
#include "cli/denoise_farm.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <functional>

#include "cli/both_ways.h"
#include "cli/denoise_frames.h"
#include "cli/fetching.h"
#include "cli/frame_store.h"
#include "cli/picture_options.h"
#include "cli/sizes.h"
#include "cli/succession.h"
#include "cli/temporary_folder.h"
#include "cli/walk.h"
#include "cli/worse.h"
#include "core/filter/given.h"
#include "core/sequence.h"
#include "proto/submission_codec.h"
#include "proto/upload.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

// A job: frames in one direction of time.
struct Row {
  bool backwards = false;
  Submission submission;
  std::vector<NoisyFrame> frames;  // by their places in the job; without pixels
  Succession succession{1};
  JobName job;  // empty: there is none
};

// The picture that came of a frame.
Image rgb_of(const fs::path& exr, const Region& region) {
  const ExrImage file = read_exr(exr);
  Image rgb(region, 3);
  for (int c = 0; c < 3; ++c) {
    const int plane = file.plane(std::string(1, "RGB"[c]));
    if (plane < 0 || file.pixels.region() != region)
      throw Error(ExitCode::internal_error, "what the farm made is not a picture of the frame");
    std::ranges::copy(file.pixels.plane(plane), rgb.plane(c).begin());
  }
  return rgb;
}

class FarmDenoiser {
 public:
  FarmDenoiser(const DenoiseOptions& o, const NoisyFiles& files, DenoiseWords& words)
      : o_(o), files_(files), words_(words), farm_(o.farm), folder_("tessera-denoise") {}

  ExitCode image() {
    Row row = row_of(false);
    NoisyFrame frame = files_.read(std::nullopt);
    wanted_ = {frame.facts.frame};
    choose_tile(frame);
    hand_in(row, std::move(frame));
    submit(row);
    write(row, nullptr);
    return outcome();
  }

  ExitCode shot(const DenoiseFrames& frames) {
    wanted_ = frames.wanted;
    Row back = row_of(true), ahead = row_of(false);
    for (auto f = frames.backwards.rbegin(); f != frames.backwards.rend(); ++f) gather(back, *f);
    for (const int f : frames.forwards) gather(ahead, f);
    submit(back);
    submit(ahead);
    if (o_.both_ways) {
      FrameStore behind(fs::path(o_.output).parent_path());
      fetch(back, [&](const NoisyFrame& f, const Image& rgb, double) { behind.put(f.facts.frame, rgb); });
      write(ahead, &behind);
    } else {
      write(ahead, nullptr);
    }
    return outcome();
  }

 private:
  using Take = std::function<void(NoisyFrame&, const Image& rgb, double seconds)>;

  Row row_of(bool backwards) const {
    Row row{.backwards = backwards,
            .submission = {},
            .frames = {},
            .succession = Succession(backwards ? -1 : 1, cuts_of(o_)),
            .job = {}};
    row.submission.name = fmt::format("denoise {}{}", fs::path(o_.input).filename().string().substr(0, 200),
                                      backwards ? " backwards" : "");
    row.submission.job.filter = files_.plan();
    row.submission.exposure = std::clamp(o_.exposure, -64.0, 64.0);
    return row;
  }

  // True if `work` was done; else the frame has failed, and it is said why.
  template <typename Work>
  bool guarded(int number, Work work) {
    try {
      work();
      return true;
    } catch (const Error& e) {
      if (e.code() == ExitCode::bad_usage) throw;
      words_.failed(number, e.what());
      if (wanted_.contains(number)) worst_ = worse(worst_, e.code());
      return false;
    }
  }

  // A frame that fails is a cut for those that follow, in either direction.
  void gather(Row& row, int number) {
    NoisyFrame frame;
    const auto read = [&] {
      frame = files_.read(number, row.backwards);
      choose_tile(frame);
    };
    if (failed_.contains(number) || !guarded(number, read)) {
      failed_.insert(number);
      return row.succession.failed(number);
    }
    hand_in(row, std::move(frame));
  }

  // Where frames differ in size the smallest is for all: tiles do not change the image.
  void choose_tile(const NoisyFrame& frame) {
    if (!o_.tile_size.empty()) {
      tile_ = tile_size_option(o_.tile_size);
      return;
    }
    const Size within = tile_within(frame.plan, frame.region(), o_.memory << 20, Job{}.tile);
    const Size before = tile_.value_or(within);
    tile_ = {std::min(before.width, within.width), std::min(before.height, within.height)};
  }

  // Uploads what the filter takes of it, as far as the farm lacks that.
  void hand_in(Row& row, NoisyFrame frame) {
    const int number = frame.facts.frame;
    const Region pixels = frame.region(), display = frame.picture.display;
    const Succession::Link link = row.succession.next(number, pixels, display);
    if (frame.plan.history() > 0 && !link.cut.empty()) words_.starts_anew(number, row.backwards, link.cut);
    if (row.backwards || wanted_.contains(number)) words_.notices(frame, !row.backwards);
    std::string bytes = exr_bytes(given_file(frame.plan, std::move(frame.gathered.input), display), "none");
    frame.gathered = {};
    frame.picture = {};
    const BlobSource blob = blob_of(std::move(bytes));
    farm_.client().upload({blob}, upload_bar(o_.quiet));
    row.submission.frames.push_back(number);
    row.submission.given.push_back(
        {{blob.digest, display, link.goes_on}, pixels, frame.facts.diameter, frame.facts.light});
    row.frames.push_back(std::move(frame));
  }

  void submit(Row& row) {
    if (row.frames.empty()) return;
    row.submission.job.tile = *tile_;
    validate(row.submission);
    const std::string submission = encode(row.submission);
    farm_.client().upload({blob_of(submission)});
    row.job = own_id(fs::path(o_.input).stem().string());
    farm_.ask<Agreed>(Submit{row.job, sha256(submission)});
    words_.handed_in(row.job, row.frames.size(), row.backwards);
  }

  // Waits for the job's end, and takes the frames that are wanted as they come.
  void fetch(Row& row, const Take& take) {
    if (row.job.empty()) return;
    const ExitCode end = fetch_job(
        farm_, {.job = row.job,
                .output = (folder_.path() / "####.exr").string(),
                .wait = true,
                .quiet = o_.quiet,
                .frames = fmt::format("{}", fmt::join(wanted_, ",")),
                .told = [&](const FrameSummary& f, const fs::path& exr) { came(row, f, exr, take); }});
    farm_end_ = worse(farm_end_, end);
  }

  void came(Row& row, const FrameSummary& f, const fs::path& exr, const Take& take) {
    const auto at = std::ranges::find(row.submission.frames, f.frame) - row.submission.frames.begin();
    const auto i = static_cast<std::size_t>(at);
    if (f.state != FrameState::completed) return lost(row, i, f.reason);
    if (exr.empty()) return;  // read for its history alone
    const Region& region = row.submission.given.at(i).region;
    guarded(f.frame, [&] {
      const Image rgb = rgb_of(exr, region);
      fs::remove(exr);
      take(row.frames[i], rgb, f.seconds);
    });
  }

  void lost(const Row& row, std::size_t i, const std::string& reason) {
    const Submission& s = row.submission;
    words_.failed(s.frames.at(i), reason.empty() ? "its job was ended before it was filtered" : reason);
    if (s.job.filter.history() > 0 && i + 1 < s.frames.size() && s.given[i + 1].given.goes_on)
      words_.starts_anew(s.frames[i + 1], row.backwards, fmt::format("frame {} failed", s.frames[i]));
  }

  void write(Row& row, const FrameStore* behind) {
    fetch(row, [&](NoisyFrame& frame, const Image& rgb, double seconds) {
      const Image back = behind ? behind->get(frame.facts.frame) : Image{};
      if (behind && back.empty()) return;  // why was said
      files_.read_again(frame, rgb.region());
      files_.write(frame, behind ? mean_of_ways(rgb, back) : rgb);
      frame.picture = {};
      words_.done(frame, *tile_, " by a farm", seconds);
      written_.insert(frame.facts.frame);
    });
  }

  // What failed on the farm matters if it was to be written.
  ExitCode outcome() const {
    if (worst_ != ExitCode::done || written_ == wanted_) return worst_;
    return farm_end_ == ExitCode::done ? ExitCode::job_failed : farm_end_;
  }

  const DenoiseOptions& o_;
  const NoisyFiles& files_;
  DenoiseWords& words_;
  FarmLink farm_;
  TemporaryFolder folder_;  // for images on their way
  std::optional<Size> tile_;
  std::set<int> wanted_, failed_, written_;
  ExitCode worst_ = ExitCode::done, farm_end_ = ExitCode::done;
};

// What the environment says of all commands is no mistake.
void require_no_device(const DenoiseOptions& o) {
  const char* usual = std::getenv("TESSERA_DEVICE");
  if (!o.device.empty() && (usual == nullptr || o.device != usual))
    refuse_option("--device", o.device, "none with --coordinator, as workers have devices of their own");
}

}  // namespace

ExitCode denoise_on_farm(const DenoiseOptions& o, const NoisyFiles& files, DenoiseWords& words) {
  require_no_device(o);
  FarmDenoiser denoiser(o, files, words);
  return is_pattern(o.input) ? denoiser.shot(frames_of(o)) : denoiser.image();
}

}  // namespace tessera
