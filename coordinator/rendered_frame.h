// SPDX-License-Identifier: Apache-2.0
// A frame from its first sample to the image that is good enough: folds blocks, stitches filtered tiles,
// looks at the error when a round is complete, and says what work comes next.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "coordinator/frame.h"
#include "core/film.h"

namespace tessera {

class RenderedFrame : public Frame {
 public:
  explicit RenderedFrame(const Job& job, bool awaits_history = false);
  // A round of the snapshot has begun. It awaits its history, whether it had it then or not. Throws
  // InputError unless the snapshot is one of this job's.
  RenderedFrame(const Job& job, FrameSnapshot snapshot);

  // What it will hold in memory, at the most.
  static double bytes(const Job& job);

  std::vector<Work> begin() override;
  std::vector<Work> fold(Block block) override;
  void stitch(const FilterTask& task, const Filtered& filtered) override;
  std::shared_ptr<const Image> kept() const override;

  bool round_complete() const override { return tiles_left_ == 0 && !stopped(); }
  std::vector<Work> look(const Budget& budget) override;
  void stop(StopReason reason) override { decision_.stop = reason; }
  bool stopped() const override { return decision_.stop.has_value(); }

  const FilmLayout& layout() const { return film_.layout(); }
  bool fits(const RenderTask& task, const Block& block) const override;
  using Frame::fits;

  FrameSnapshot snapshot() const override;
  std::vector<Work> outstanding() const override;

  FrameImage image() const& override { return image(film_.sums()); }
  FrameImage image() && override { return image(std::move(film_).sums()); }  // with the film itself
  // This round's filtered tiles, elsewhere the image of the last look; before the first one the noisy film,
  // black where it has no samples.
  Image preview() const override;
  Progress progress(double seconds) const override;
  int round() const override { return round_; }
  bool seen() const override { return looks_taken_ > 0; }
  int columns() const override { return columns_; }
  std::span<const CellState> cell_states() const override { return decision_.cells; }

 private:
  FrameImage image(Image sums) const;
  std::vector<Work> start_round(const std::vector<int>& want);
  std::vector<Work> cell_done(std::size_t cell);
  void keep_seen();
  CellLook look_at(std::size_t cell) const;
  std::optional<ErrorEstimate> hold_out(std::size_t cell, const Image& weight) const;
  std::size_t cell_at(int x, int y) const;
  double samples_after_this_round() const;

  Image taken(const Region& outer) const override;
  Image motion(const Image& taken) const override {
    return developed(taken, taken_, channels_of(Aov::motion), Part::all);
  }

  std::vector<Region> cells_;
  int columns_ = 0;
  std::vector<Tile> tiles_;
  std::map<Region, std::size_t> tile_at_;  // by inner region

  Film film_;
  FilmLayout taken_;               // of what is filtered,
  std::vector<int> taken_planes_;  // and where it lies in the film
  Image stitched_;   // filtered_planes() over the frame, this round's tiles replacing older ones
  Image seen_;       // RGB delivered at the last look
  Image seen_sums_;  // colour sums of the halves and their counts at the last look

  int round_ = 0;  // number of the round under way, from 1
  int looks_taken_ = 0;
  std::vector<int> have_, want_;                         // samples of each cell before and after this round
  std::vector<std::vector<std::size_t>> tiles_of_cell_;  // tiles whose outer region the cell touches
  std::vector<int>
      cells_left_;  // of each tile, cells of this round that it still waits for; -1: not in this round
  std::vector<bool> cell_open_;                        // cells of this round that are not complete
  int tiles_round_ = 0, tiles_left_ = 0;               // of this round; of them, not stitched yet
  std::int64_t samples_done_ = 0, samples_round_ = 0;  // see Progress
  std::vector<bool> tile_stitched_;
  std::vector<bool> cell_changed_;  // pixels that its error depends on were stitched in this round
  std::vector<CellLook> looks_;
  Decision decision_;
};

}  // namespace tessera
