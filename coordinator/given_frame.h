// SPDX-License-Identifier: Apache-2.0
// A frame whose planes are there already, and that is only filtered: all its tiles at once, after its
// history. It is done when all of them are stitched; nothing is estimated.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "coordinator/frame.h"

namespace tessera {

class GivenFrame : public Frame {
 public:
  // `planes`: those of job.filter.inputs() over job.region(). Null: they cannot be had, and the frame is
  // there only to be told of; no work is taken from it. Throws InputError for planes of another shape.
  GivenFrame(const Job& job, Planes planes, bool awaits_history = false);
  // It has one round only, and the snapshot of its begin holds nothing else.
  GivenFrame(const Job& job, Planes planes, const FrameSnapshot& snapshot);

  // What it will hold in memory, at the most.
  static double bytes(const Job& job);

  std::vector<Work> begin() override { return ready(tasks()); }
  std::vector<Work> fold(Block) override { return {}; }
  void stitch(const FilterTask& task, const Filtered& filtered) override;
  std::shared_ptr<const Image> kept() const override;

  bool round_complete() const override { return open_.empty() && !stopped(); }
  std::vector<Work> look(const Budget& budget) override;
  void stop(StopReason reason) override { stop_ = reason; }
  bool stopped() const override { return stop_.has_value(); }

  bool fits(const RenderTask&, const Block&) const override { return false; }
  using Frame::fits;
  FrameSnapshot snapshot() const override { return {}; }
  std::vector<Work> outstanding() const override;

  FrameImage image() const& override;
  using Frame::image;
  // The tiles that are there, elsewhere the noisy picture.
  Image preview() const override;
  Progress progress(double seconds) const override;
  int round() const override { return 1; }

 private:
  std::vector<Work> tasks() const;
  Image taken(const Region& outer) const override { return cropped(*planes_, outer); }
  Image motion(const Image& taken) const override;

  Planes planes_;
  std::map<Region, Tile> open_;  // tiles that are not stitched yet, by inner region
  int tiles_ = 0;                // with those that are
  Image stitched_;               // RGB and what is kept
  std::optional<StopReason> stop_;
};

}  // namespace tessera
