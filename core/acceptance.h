// SPDX-License-Identifier: Apache-2.0
// The stop rule: errors and budget in, acceptance or more samples out. No pixels, no clock. Decided per cell
// from merged state, so it depends on the picture and never on who was fast or how the work was cut.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/job.h"
#include "core/quality/estimate.h"

namespace tessera {

// Why a cell must not stop yet although its error looks small.
enum class Guard : unsigned char {
  none,
  concentrated_energy,  // most energy in few pixels, and the halves disagree about which
  heavy_tails,          // kurtosis of the halves' normalised difference
  single_sample,        // one sample could move the cell's mean by more than the target
  too_dark,             // too few samples that carried light
};
std::string_view to_string(Guard);

// One cell at one look.
struct CellLook {
  int samples = 0;                        // per pixel
  ErrorEstimate error;                    // T, of the image of this look
  std::optional<ErrorEstimate> hold_out;  // H, of the image of the look before
  Guard guard = Guard::none;
};

enum class CellStatus : unsigned char { open, accepted, exhausted };

// What is remembered of a cell between looks.
struct CellState {
  CellStatus status = CellStatus::open;
  int samples = 0;
  int good_looks = 0;  // consecutive looks below the target
  ErrorEstimate error;
  Guard guard = Guard::none;
  bool operator==(const CellState&) const = default;
};

struct Budget {
  double seconds = 0;  // of wall time so far
  bool interrupted = false;
};

enum class StopReason : unsigned char { accepted, max_samples, max_seconds, interrupted };
std::string_view to_string(StopReason);

struct Decision {
  std::optional<StopReason> stop;  // set: the frame is finished
  std::vector<int> want;           // samples per cell for the next round (= what it has where it may rest)
  std::vector<CellState> cells;    // to be handed back at the next look
  ErrorEstimate frame;             // mean over pixels, over all cells
  double acceptable_share = 0;     // of the cells: accepted ones
};

// `cells` are laid out row-major, `columns` wide; `areas` are their pixel counts. `before` is empty at first.
Decision decide(const AcceptanceRule&, int columns, const std::vector<std::int64_t>& areas,
                const std::vector<CellState>& before, const std::vector<CellLook>& looks, const Budget&);

}  // namespace tessera
