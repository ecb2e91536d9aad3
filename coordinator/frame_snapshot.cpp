// SPDX-License-Identifier: Apache-2.0
// A frame to a value and back, and what of its round is left to do.
#include <bit>
#include <cassert>

#include "coordinator/rendered_frame.h"
#include "core/error.h"

namespace tessera {
namespace {

void require(bool good, std::string_view what) {
  if (!good) throw InputError("snapshot of a frame", what);
}

// What a cell can have after whole rounds.
bool is_count(int samples, const Job& job) {
  return samples >= kLeafSamples && samples <= job.acceptance.max_samples &&
         std::has_single_bit(unsigned(samples));
}

void require_counts(const FrameSnapshot& s, const Job& job, std::size_t cells) {
  require(s.round >= 1, "its round is not one");
  require(s.have.size() == cells && s.want.size() == cells, "it has not as many cells as the job");
  for (std::size_t c = 0; c < cells; ++c) {
    const bool first = s.round == 1;
    require(first ? s.have[c] == 0 : is_count(s.have[c], job), "a cell has samples that no round gives it");
    require(is_count(s.want[c], job) && s.want[c] >= s.have[c],
            "a cell wants samples that no round gives it");
  }
  require(s.want != s.have, "nothing is left to do in its round");
}

bool is_image_of(const Image& image, const Region& region, int planes) {
  return image.region() == region && image.planes() == planes;
}

void require_images(const FrameSnapshot& s, const Job& job, int film_planes) {
  if (s.round == 1)
    return require(s.sums.empty() && s.stitched.empty(), "it has images before there are any");
  require(is_image_of(s.sums, job.region(), film_planes), "its film is not one of the job");
  require(is_image_of(s.stitched, job.region(), filtered_planes(job.filter)),
          "its filtered planes are not those of the job");
}

}  // namespace

RenderedFrame::RenderedFrame(const Job& job, FrameSnapshot s) : RenderedFrame(job, true) {
  require_counts(s, job, cells_.size());
  require_images(s, job, layout().planes());
  const std::size_t looked = s.round == 1 ? 0 : cells_.size();
  require(s.looks.size() == looked && s.states.size() == looked, "it has not a look of every cell");
  round_ = looks_taken_ = s.round - 1;
  have_ = std::move(s.have);
  if (seen()) {
    std::vector<int> samples(static_cast<std::size_t>(film_.region().area()));
    const Region& frame = film_.region();
    for (std::size_t c = 0; c < cells_.size(); ++c)
      for (int y = cells_[c].y0; y < cells_[c].y1; ++y)
        std::fill_n(samples.begin() + std::int64_t(y - frame.y0) * frame.width() + (cells_[c].x0 - frame.x0),
                    cells_[c].width(), have_[c]);
    film_ = Film(layout().aovs(), std::move(s.sums), std::move(samples));
    stitched_ = std::move(s.stitched);
    looks_ = std::move(s.looks);
    keep_seen();
  }
  decision_ = {std::nullopt, s.want, std::move(s.states), s.error, s.acceptable_share};
  for (std::size_t c = 0; c < cells_.size(); ++c) samples_done_ += cells_[c].area() * have_[c];
  samples_round_ = samples_done_;
  start_round(s.want);
}

FrameSnapshot RenderedFrame::snapshot() const {
  assert(round_ >= 1 && !stopped() && film_.settled() && samples_done_ < samples_round_);
  FrameSnapshot s{.round = round_, .have = have_, .want = want_};
  if (!seen()) return s;
  s.looks = looks_;
  s.states = decision_.cells;
  s.error = decision_.frame;
  s.acceptable_share = decision_.acceptable_share;
  s.sums = film_.sums();
  s.stitched = stitched_;
  return s;
}

std::vector<Work> RenderedFrame::outstanding() const {
  std::vector<Work> work;
  if (stopped()) return work;
  for (const RenderTask& task : plan_render(job(), have_, want_))
    if (!film_.has(task.region, task.samples)) work.emplace_back(task);
  if (awaits_history()) return work;
  for (std::size_t t = 0; t < tiles_.size(); ++t)
    if (cells_left_[t] == 0 && !tile_stitched_[t]) work.emplace_back(FilterTask{tiles_[t], round_});
  return work;
}

}  // namespace tessera
