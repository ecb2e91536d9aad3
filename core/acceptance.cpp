// SPDX-License-Identifier: Apache-2.0
#include "core/acceptance.h"

#include <algorithm>
#include <cassert>

namespace tessera {
namespace {

constexpr double kOneLook = 2.5;           // one-sided 99.4 %: eight looks at 5 % together (Bonferroni)
constexpr double kNeighbourTargets = 4.0;  // a cell may rest beside cells up to here
constexpr double kReopenTargets = 1.5;
constexpr int kNeighbourRatio = 4;  // of sample counts

struct Grid {
  int columns = 0, rows = 0;

  // Calls `visit(index)` for the cells around `cell`.
  template <typename Visit>
  void around(int cell, const Visit& visit) const {
    const int x = cell % columns, y = cell / columns;
    for (int v = std::max(0, y - 1); v <= std::min(rows - 1, y + 1); ++v)
      for (int u = std::max(0, x - 1); u <= std::min(columns - 1, x + 1); ++u)
        if (u != x || v != y) visit(v * columns + u);
  }
};

// The estimates to judge by.
std::vector<ErrorEstimate> judged(const Grid& grid, const std::vector<std::int64_t>& areas,
                                  const std::vector<CellLook>& looks) {
  std::vector<ErrorEstimate> errors;
  for (int i = 0; i < static_cast<int>(looks.size()); ++i) {
    std::vector<ErrorEstimate> members{looks[i].error};
    std::vector<double> pixels{static_cast<double>(areas[i])};
    if (areas[i] < kSmallCell)
      grid.around(i, [&](int n) {
        members.push_back(looks[n].error);
        pixels.push_back(static_cast<double>(areas[n]));
      });
    errors.push_back(members.size() == 1 ? looks[i].error : pooled(members, pixels));
  }
  return errors;
}

ErrorEstimate frame_error(const std::vector<std::int64_t>& areas, const std::vector<CellLook>& looks) {
  std::vector<ErrorEstimate> errors;
  for (const CellLook& look : looks) errors.push_back(look.error);
  return pooled(errors, {areas.begin(), areas.end()});
}

bool neighbours_are_calm(const Grid& grid, const std::vector<ErrorEstimate>& errors, int cell,
                         double target) {
  bool calm = true;
  grid.around(cell, [&](int n) { calm = calm && errors[n].upper(kTwoLooks) < kNeighbourTargets * target; });
  return calm;
}

// A cell's state after a look, its neighbours left aside.
CellState seen(const CellState& before, const CellLook& look, const ErrorEstimate& error, double target) {
  CellState now{before.status, look.samples, before.good_looks, look.error, look.guard};
  const bool good = look.guard == Guard::none && error.upper(kTwoLooks) < target;
  const bool held = !look.hold_out || look.hold_out->upper(kTwoLooks) < target;
  const bool new_samples = look.samples > before.samples;
  // What the hold-out refutes was not a good look: this one is then the first again.
  if (new_samples) now.good_looks = !good ? 0 : held ? before.good_looks + 1 : 1;
  if (now.status == CellStatus::accepted && error.mean > kReopenTargets * target) {
    now.status = CellStatus::open;
    now.good_looks = 0;
  }
  return now;
}

bool may_rest(const CellLook& look, const ErrorEstimate& error, int good_looks, double target) {
  if (look.guard != Guard::none) return false;
  if (error.upper(kOneLook) < target) return true;
  return good_looks >= 2 && error.upper(kTwoLooks) < target;
}

std::vector<CellState> judge(const AcceptanceRule& rule, const Grid& grid,
                             const std::vector<ErrorEstimate>& errors, const std::vector<CellState>& before,
                             const std::vector<CellLook>& looks) {
  std::vector<CellState> cells;
  for (int i = 0; i < static_cast<int>(looks.size()); ++i) {
    CellState now = seen(before[i], looks[i], errors[i], *rule.relmse);
    if (now.status != CellStatus::accepted) {
      const bool rest = may_rest(looks[i], errors[i], now.good_looks, *rule.relmse) &&
                        neighbours_are_calm(grid, errors, i, *rule.relmse);
      now.status = rest                                   ? CellStatus::accepted
                   : looks[i].samples >= rule.max_samples ? CellStatus::exhausted
                                                          : CellStatus::open;
    }
    cells.push_back(now);
  }
  return cells;
}

std::vector<CellState> without_target(const AcceptanceRule& rule, const std::vector<CellLook>& looks) {
  std::vector<CellState> cells;
  for (const CellLook& look : looks)
    cells.push_back({look.samples >= rule.max_samples ? CellStatus::accepted : CellStatus::open, look.samples,
                     0, look.error, look.guard});
  return cells;
}

// All cells rest but the frame does not pass: those above the target work on. There is at least one, as the
// frame's bound is at most the mean of the cells' bounds.
void reopen_above(const AcceptanceRule& rule, std::vector<CellState>& cells) {
  for (CellState& cell : cells)
    if (cell.error.upper(kTwoLooks) >= *rule.relmse)
      cell.status = cell.samples < rule.max_samples ? CellStatus::open : CellStatus::exhausted;
}

std::vector<int> samples_wanted(const AcceptanceRule& rule, const Grid& grid,
                                const std::vector<CellState>& cells) {
  std::vector<int> want;
  for (const CellState& cell : cells)
    want.push_back(cell.status == CellStatus::open ? std::min(2 * cell.samples, rule.max_samples)
                                                   : cell.samples);
  for (bool changed = true; changed;) {
    changed = false;
    for (int i = 0; i < static_cast<int>(want.size()); ++i)
      grid.around(i, [&](int n) {
        if (want[i] >= want[n] / kNeighbourRatio) return;
        want[i] = want[n] / kNeighbourRatio;
        changed = true;
      });
  }
  return want;
}

bool all(const std::vector<CellState>& cells, CellStatus status) {
  return std::ranges::all_of(cells, [&](const CellState& c) { return c.status == status; });
}

std::optional<StopReason> stop_reason(const AcceptanceRule& rule, const std::vector<CellState>& cells,
                                      const Budget& budget) {
  if (all(cells, CellStatus::accepted)) return rule.relmse ? StopReason::accepted : StopReason::max_samples;
  if (std::ranges::none_of(cells, [](const CellState& c) { return c.status == CellStatus::open; }))
    return StopReason::max_samples;
  if (rule.max_seconds && budget.seconds >= *rule.max_seconds) return StopReason::max_seconds;
  return std::nullopt;
}

}  // namespace

std::string_view to_string(StopReason reason) {
  switch (reason) {
    case StopReason::accepted:
      return "accepted";
    case StopReason::max_samples:
      return "max_samples";
    case StopReason::max_seconds:
      return "max_seconds";
    case StopReason::interrupted:
      return "interrupted";
    case StopReason::filtered:
      return "filtered";
  }
  return "";
}

std::vector<int> first_round(const AcceptanceRule& rule, std::size_t cells) {
  constexpr int kMostAtOnce = 4096;  // so that the tasks of a round stay countable
  const bool looks = rule.relmse || rule.max_seconds;
  return std::vector<int>(cells, looks ? rule.first_samples : std::min(rule.max_samples, kMostAtOnce));
}

Decision decide(const AcceptanceRule& rule, int columns, const std::vector<std::int64_t>& areas,
                const std::vector<CellState>& before, const std::vector<CellLook>& looks,
                const Budget& budget) {
  const std::size_t count = looks.size();
  assert(count > 0 && columns > 0 && count % columns == 0 && areas.size() == count);
  assert(before.empty() || before.size() == count);
  const Grid grid{columns, static_cast<int>(count) / columns};
  Decision decision;
  decision.frame = frame_error(areas, looks);
  if (rule.relmse) {
    const std::vector<CellState> first(before.empty() ? count : 0);
    decision.cells = judge(rule, grid, judged(grid, areas, looks), before.empty() ? first : before, looks);
    if (all(decision.cells, CellStatus::accepted) && decision.frame.upper(kTwoLooks) > *rule.relmse)
      reopen_above(rule, decision.cells);
  } else {
    decision.cells = without_target(rule, looks);
  }
  decision.stop = stop_reason(rule, decision.cells, budget);
  if (decision.stop)
    for (const CellLook& look : looks) decision.want.push_back(look.samples);
  else
    decision.want = samples_wanted(rule, grid, decision.cells);
  const auto accepted = std::ranges::count(decision.cells, CellStatus::accepted, &CellState::status);
  decision.acceptable_share = static_cast<double>(accepted) / static_cast<double>(count);
  return decision;
}

}  // namespace tessera
