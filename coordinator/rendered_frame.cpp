// SPDX-License-Identifier: Apache-2.0
#include "coordinator/rendered_frame.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include "core/quality/guards.h"

namespace tessera {
namespace {

// The colour planes a look at the error needs: halves' sums and counts, in the order of `seen_sums_`.
constexpr int kSeenPlanes = 8;

std::array<int, kSeenPlanes> seen_planes(const FilmLayout& layout) {
  std::array<int, kSeenPlanes> planes{FilmLayout::count(Half::a), FilmLayout::count(Half::b)};
  for (int c = 0; c < 3; ++c) {
    planes[2 + 2 * c] = layout.sum(Aov::color, c, Half::a);
    planes[3 + 2 * c] = layout.sum(Aov::color, c, Half::b);
  }
  return planes;
}

Image picked(const Image& image, const Region& region, std::span<const int> planes) {
  Image out = Image::unset(region, static_cast<int>(planes.size()));
  for (std::size_t p = 0; p < planes.size(); ++p)
    for (int y = region.y0; y < region.y1; ++y) {
      const auto from = image.row(planes[p], y).subspan(region.x0 - image.region().x0, region.width());
      std::copy(from.begin(), from.end(), out.row(static_cast<int>(p), y).begin());
    }
  return out;
}

// The mean of the samples of one half that came between two snapshots of seen_planes().
Image mean_of_new(const Image& before, const Image& now, Half half) {
  Image mean = Image::unset(now.region(), 3);
  const int h = static_cast<int>(half);
  for (std::size_t i = 0; i < mean.plane(0).size(); ++i) {
    const float n = now.plane(h)[i] - before.plane(h)[i];
    for (int c = 0; c < 3; ++c) {
      const float sum = now.plane(2 + 2 * c + h)[i] - before.plane(2 + 2 * c + h)[i];
      mean.plane(c)[i] = n > 0 ? sum / n : 0.0f;
    }
  }
  return mean;
}

Image mean_of(const Image& a, const Image& b) {
  Image mean = a;
  const auto to = mean.data();
  const auto from = b.data();
  for (std::size_t i = 0; i < to.size(); ++i) to[i] = 0.5f * (to[i] + from[i]);
  return mean;
}

constexpr std::array kAll{0, 1, 2}, kHalfA{3, 4, 5}, kHalfB{6, 7, 8};

}  // namespace

RenderedFrame::RenderedFrame(const Job& job, bool awaits_history)
    : Frame(job, awaits_history),
      cells_(plan_cells(job)),
      tiles_(plan_tiles(job)),
      film_(job.region(), film_aovs(job)),
      taken_(filter_aovs(job)),
      taken_planes_(layout().planes_of(taken_)),
      stitched_(job.region(), filtered_planes(job.filter)),
      have_(cells_.size(), 0),
      tiles_of_cell_(cells_.size()),
      tile_stitched_(tiles_.size()),
      looks_(cells_.size()) {
  columns_ = static_cast<int>(std::count_if(cells_.begin(), cells_.end(),
                                            [&](const Region& c) { return c.y0 == cells_.front().y0; }));
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    tile_at_[tiles_[t].inner] = t;
    for (const Region& part : grid_cells(tiles_[t].outer, {kCellEdge, kCellEdge}))
      tiles_of_cell_[cell_at(part.x0, part.y0)].push_back(t);
  }
}

// The film, its blocks that wait for a sibling, the stitched planes, what was seen of both, a copy to write,
// and the history of the frame before.
double RenderedFrame::bytes(const Job& job) {
  const double film = FilmLayout(film_aovs(job)).planes();
  return static_cast<double>(job.region().area()) * sizeof(float) *
         (3 * film + filtered_planes(job.filter) + history_planes(job.filter) + kSeenPlanes + 4);
}

std::vector<Work> RenderedFrame::begin() { return start_round(first_round(job().acceptance, cells_.size())); }

std::vector<Work> RenderedFrame::start_round(const std::vector<int>& want) {
  ++round_;
  want_ = want;
  cells_left_.assign(tiles_.size(), -1);
  cell_open_.assign(cells_.size(), false);
  cell_changed_.assign(cells_.size(), false);
  tile_stitched_.assign(tiles_.size(), false);
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    if (want_[c] == have_[c]) continue;
    cell_open_[c] = true;
    for (std::size_t t : tiles_of_cell_[c]) cells_left_[t] = std::max(cells_left_[t], 0) + 1;
  }
  tiles_round_ = tiles_left_ = static_cast<int>(
      std::count_if(cells_left_.begin(), cells_left_.end(), [](int left) { return left >= 0; }));
  std::vector<Work> work;
  for (const RenderTask& task : plan_render(job(), have_, want_)) {
    work.emplace_back(task);
    samples_round_ += task.region.area() * task.samples.count();
  }
  return work;
}

std::size_t RenderedFrame::cell_at(int x, int y) const {
  const Region& first = cells_.front();
  const int column = x / kCellEdge - first.x0 / kCellEdge, row = y / kCellEdge - first.y0 / kCellEdge;
  return static_cast<std::size_t>(row) * columns_ + column;
}

std::vector<Work> RenderedFrame::fold(Block block) {
  const Region region = block.sums.region();
  const std::int64_t samples = region.area() * block.samples.count();
  if (stopped() || !film_.fold(std::move(block))) return {};
  samples_done_ += samples;
  const std::size_t cell = cell_at(region.x0, region.y0);
  if (!cell_open_[cell] || !film_.covers(cells_[cell], want_[cell])) return {};
  return cell_done(cell);
}

std::vector<Work> RenderedFrame::cell_done(std::size_t cell) {
  cell_open_[cell] = false;
  std::vector<Work> ready;
  for (std::size_t t : tiles_of_cell_[cell])
    if (--cells_left_[t] == 0) ready.emplace_back(FilterTask{tiles_[t], round_});
  return Frame::ready(std::move(ready));
}

std::shared_ptr<const Image> RenderedFrame::kept() const {
  const int planes = history_planes(job().filter);
  assert(stopped() && planes > 0);
  return std::make_shared<const Image>(planes_of(stitched_, kFilteredPlanes, planes));
}

Image RenderedFrame::taken(const Region& outer) const { return picked(film_.sums(), outer, taken_planes_); }

void RenderedFrame::stitch(const FilterTask& task, const Filtered& filtered) {
  const auto tile = tile_at_.find(task.tile.inner);
  if (stopped() || task.round != round_ || tile == tile_at_.end() || tile_stitched_[tile->second]) return;
  paste(stitched_, filtered);
  tile_stitched_[tile->second] = true;
  --tiles_left_;
  const Region seen_from = intersect(grown(task.tile.inner, kWeightRadius), film_.region());
  for (const Region& part : grid_cells(seen_from, {kCellEdge, kCellEdge}))
    cell_changed_[cell_at(part.x0, part.y0)] = true;
}

std::vector<Work> RenderedFrame::look(const Budget& budget) {
  assert(round_complete());
  std::vector<std::int64_t> areas;
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    areas.push_back(cells_[c].area());
    if (cell_changed_[c])
      looks_[c] = look_at(c);
    else
      looks_[c].hold_out.reset();  // it takes new samples
  }
  decision_ = decide(job().acceptance, columns_, areas, decision_.cells, looks_, budget);
  ++looks_taken_;
  have_ = want_;
  keep_seen();
  return stopped() ? std::vector<Work>{} : start_round(decision_.want);
}

void RenderedFrame::keep_seen() {
  seen_ = picked(stitched_, stitched_.region(), kAll);
  seen_sums_ = picked(film_.sums(), film_.region(), seen_planes(layout()));
}

CellLook RenderedFrame::look_at(std::size_t c) const {
  const Region& cell = cells_[c];
  const Region around = intersect(grown(cell, kWeightRadius), film_.region());
  const Image y = mean_of(picked(stitched_, around, kHalfA), picked(stitched_, around, kHalfB));
  const Image weight = relative_weight(y, cell);
  const Image sums = cropped(film_.sums(), cell);
  const auto means = channels_of(Aov::color);
  const Image a = developed(sums, layout(), means, Part::a), b = developed(sums, layout(), means, Part::b);

  CellLook look;
  look.samples = want_[c];
  look.error = estimate_from_halves({a, b, picked(stitched_, cell, kHalfA), picked(stitched_, cell, kHalfB)},
                                    weight, cell);
  look.hold_out = hold_out(c, weight);
  // A guard matters only where the error looks good; a small cell's may, beside its neighbours'.
  const auto target = job().acceptance.relmse;
  if (target && (cell.area() < kSmallCell || look.error.upper(kTwoLooks) < *target))
    look.guard = guard_of(sums, layout(), cell, *target);
  return look;
}

std::optional<ErrorEstimate> RenderedFrame::hold_out(std::size_t c, const Image& weight) const {
  if (have_[c] == 0 || want_[c] == have_[c]) return std::nullopt;
  const Region& cell = cells_[c];
  const Image before = cropped(seen_sums_, cell), now = picked(film_.sums(), cell, seen_planes(layout()));
  return estimate_from_hold_out(cropped(seen_, cell), mean_of_new(before, now, Half::a),
                                mean_of_new(before, now, Half::b), weight, cell);
}

bool RenderedFrame::fits(const RenderTask& task, const Block& block) const {
  return block.samples == task.samples && block.sums.region() == task.region &&
         block.sums.planes() == layout().planes();
}

FrameImage RenderedFrame::image(Image sums) const {
  FrameImage image;
  image.layout = layout();
  image.filtered = seen_.empty() ? developed(sums, layout(), channels_of(Aov::color), Part::all) : seen_;
  image.sums = std::move(sums);
  image.cells = cells_;
  image.states = decision_.cells;
  image.error = decision_.frame;
  image.acceptable_share = decision_.acceptable_share;
  image.stop = decision_.stop;
  image.rounds = looks_taken_;
  image.pixel_samples = samples_done_;
  return image;
}

Image RenderedFrame::preview() const {
  Image shown = seen() ? seen_ : developed(film_.sums(), layout(), channels_of(Aov::color), Part::all);
  for (std::size_t t = 0; t < tiles_.size(); ++t)
    if (tile_stitched_[t]) paste(shown, picked(stitched_, tiles_[t].inner, kAll));
  return shown;
}

// Pixel samples that later rounds will probably need: errors fall about as n^-0.8 behind a filter.
double RenderedFrame::samples_after_this_round() const {
  double samples = 0;
  const AcceptanceRule& rule = job().acceptance;
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    double needed = want_[c];
    if (!rule.relmse)
      needed = rule.max_samples;
    else if (!seen())
      needed = 4.0 * want_[c];  // nothing is known yet: two more rounds
    else if (decision_.cells[c].status == CellStatus::open)
      needed =
          have_[c] * std::pow(std::max(1.0, decision_.cells[c].error.upper(kTwoLooks) / *rule.relmse), 1.25);
    samples += static_cast<double>(cells_[c].area()) *
               (std::clamp<double>(needed, want_[c], rule.max_samples) - want_[c]);
  }
  return samples;
}

Progress RenderedFrame::progress(double seconds) const {
  Progress p;
  p.round = round_;
  p.samples_done = samples_done_;
  p.samples_round = samples_round_;
  p.tiles_round = tiles_round_;
  p.tiles_done = tiles_round_ - tiles_left_;
  if (seen()) p.error = decision_.frame.mean;
  p.target = job().acceptance.relmse;
  p.acceptable_share = decision_.acceptable_share;
  p.seconds = seconds;
  const double done = static_cast<double>(samples_done_);
  const double all = static_cast<double>(samples_round_) + samples_after_this_round();
  p.fraction = stopped() ? 1.0 : std::min(0.999, done / all);
  if (done > 0 && !stopped()) p.seconds_left = seconds * (all - done) / done;
  return p;
}

}  // namespace tessera
