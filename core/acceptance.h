// SPDX-License-Identifier: Apache-2.0
// The stop rule: errors and budget in, acceptance or more samples out. No pixels, no clock. Decided per cell
// from merged state, so it depends on the picture and never on who was fast or how the work was cut; never
// per pixel, which would darken the image (Kirk & Arvo 1991).
//
// A cell is good at a look if no guard holds and the upper bound of its error, 1.645 standard errors above
// the estimate, is below the target. It is accepted when it is good at two looks in a row, each with new
// samples, and at the second the hold-out bound (if there is one) is below the target too; or at once
// when 2.5 standard errors are below. All the while its neighbours must be below four times the target. It
// opens again if its estimate, which its neighbours' samples still change, exceeds 1.5 times the target. One
// look at 1.645 would not do: of many looks, those that seem good are the lucky ones.
//
// A cell that is not accepted gets twice the samples it has, up to max_samples. So that filters, which take
// the noise within their window as comparable, are not misled, the counts of neighbours stay within a factor
// of four: a cell at rest is doubled when a neighbour would leave it behind.
//
// The frame is accepted when every cell is, and the bound of its mean over pixels is at most the target.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/job.h"
#include "core/quality/estimate.h"
#include "core/quality/guards.h"

namespace tessera {

inline constexpr double kTwoLooks = 1.645;  // standard errors; one-sided 95 %
// Cells with fewer pixels, at the frame's edges, say too little alone and are judged with their neighbours.
inline constexpr std::int64_t kSmallCell = kCellEdge * kCellEdge / 4;

// One cell at one look.
struct CellLook {
  int samples = 0;                        // per pixel
  ErrorEstimate error;                    // T, of the image of this look
  std::optional<ErrorEstimate> hold_out;  // H, of the image of the look before
  Guard guard = Guard::none;
};

enum class CellStatus : unsigned char {
  open,
  accepted,   // at rest; without a target: has max_samples
  exhausted,  // has max_samples and is not acceptable
};

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
};

enum class StopReason : unsigned char {
  accepted,
  max_samples,
  max_seconds,
  interrupted,
  filtered  // all there was to do with a frame that is given
};
std::string_view to_string(StopReason);

struct Decision {
  std::optional<StopReason> stop;  // set: the frame is finished
  std::vector<int> want;           // samples per cell for the next round (= what it has where it may rest)
  std::vector<CellState> cells;    // to be handed back at the next look
  ErrorEstimate frame;             // mean over pixels, over all cells
  double acceptable_share = 0;     // of the cells: accepted ones
};

// The samples per cell of the first round: the rule's first_samples; or max_samples at once (4096 at the
// most) if there is neither a target nor a time limit to look at on the way.
std::vector<int> first_round(const AcceptanceRule&, std::size_t cells);

// `cells` are laid out row-major, `columns` wide; `areas` are their pixel counts. `before` is empty at the
// first look. `looks` are of all cells, those at rest too. Without a target samples double up to max_samples.
Decision decide(const AcceptanceRule&, int columns, const std::vector<std::int64_t>& areas,
                const std::vector<CellState>& before, const std::vector<CellLook>& looks, const Budget&);

}  // namespace tessera
