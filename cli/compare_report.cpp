// SPDX-License-Identifier: Apache-2.0
#include "cli/compare_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>

namespace tessera {
namespace {

using Json = nlohmann::ordered_json;  // numbers that are not finite become null

std::string domain_of(const Figure& f) {
  return f.exposure ? fmt::format("{}, exposure {:+g}", f.domain, *f.exposure) : f.domain;
}

// A NaN's sign means nothing, but would be printed.
double unsigned_nan(double v) { return std::isnan(v) ? std::abs(v) : v; }

std::string beside(const Figure& f) {
  return f.remark.empty() ? domain_of(f) : fmt::format("{}; {}", domain_of(f), f.remark);
}

// Text.

void write_cells(std::ostream& out, const CellTable& table) {
  out << fmt::format("cells, {} ({})\n{:>7}{:>7}{:>7}{:>7}{:>13}{:>13}{:>13}\n", table.metric,
                     domain_of(table.of), "x", "y", "width", "height", "mean", "99 %", "worst 8 x 8");
  for (const CellErrors& c : table.cells)
    out << fmt::format("{:>7}{:>7}{:>7}{:>7}{:>13.6g}{:>13.6g}{:>13.6g}\n", c.cell.x0, c.cell.y0,
                       c.cell.width(), c.cell.height(), unsigned_nan(c.mean), unsigned_nan(c.percentile_99),
                       unsigned_nan(c.worst_block));
}

// What is said of a frame below its figures.
void write_remarks(std::ostream& out, const FrameReport& r) {
  for (const CellTable& table : r.cells) write_cells(out, table);
  const auto count = [](const FileFacts& f, std::string_view whose) {
    const std::string first = f.not_finite > 0 ? fmt::format(", the first at ({}, {})", f.first_not_finite[0],
                                                             f.first_not_finite[1])
                                               : "";
    return fmt::format("{} pixels of the {}{}", f.not_finite, whose, first);
  };
  if (r.image.not_finite + r.reference.not_finite > 0)
    out << fmt::format("not finite: {}; {}\n", count(r.image, "image"), count(r.reference, "reference"));
  for (const WrittenMap& m : r.maps)
    out << fmt::format("map of {} per pixel, 0 (black) to {:g} (yellow): {}\n", m.metric, m.high,
                       m.file.string());
}

void write_text(std::ostream& out, const FrameReport& r) {
  for (const Figure& f : r.figures)
    out << fmt::format("{:<18} {:>12.6g}  {}\n", f.label, unsigned_nan(f.value), beside(f));
  write_remarks(out, r);
}

void write_frame_table(std::ostream& out, const SequenceReport& s, const std::vector<Summary>& columns) {
  const auto width = [](const Summary& column) {
    return std::max<std::size_t>(13, column.figure.key.size() + 2);
  };
  out << "\nframe  ";
  for (const Summary& c : columns) out << fmt::format("{:>{}}", c.figure.key, width(c));
  for (const FrameReport& frame : s.frames) {
    out << fmt::format("\n{:<7}", frame.frame);
    for (const Summary& c : columns) {
      const auto f = std::ranges::find(frame.figures, c.figure.key, &Figure::key);
      out << (f == frame.figures.end() ? std::string(width(c), ' ')
                                       : fmt::format("{:>{}.6g}", unsigned_nan(f->value), width(c)));
    }
  }
  out << '\n';
}

void write_text(std::ostream& out, const SequenceReport& s) {
  const std::vector<Summary> all = summaries(s);
  out << fmt::format("{:<18} {:>12} {:>12} {:>7}\n", fmt::format("{} frames", s.frames.size()), "mean",
                     "worst", "frame");
  for (const Summary& one : all)
    out << fmt::format("{:<18} {:>12.6g} {:>12.6g} {:>7}  {}\n", one.figure.label, unsigned_nan(one.mean),
                       unsigned_nan(one.worst), one.worst_frame, beside(one.figure));
  for (const Figure& f : s.over_frames)
    out << fmt::format("{:<18} {:>12.6g} {:>12} {:>7}  {}\n", f.label, unsigned_nan(f.value), "", "",
                       beside(f));
  write_frame_table(out, s, all);
  for (const FrameReport& frame : s.frames) {
    if (frame.cells.empty() && frame.maps.empty() && frame.image.not_finite + frame.reference.not_finite == 0)
      continue;
    out << fmt::format("\nframe {}\n", frame.frame);
    write_remarks(out, frame);
  }
}

// JSON.

Json json(const FileFacts& facts) {
  Json j = Json::object();
  for (const auto& [name, value] : facts.origin)
    std::visit([&, key = name](const auto& v) { j[key] = v; }, value);
  return j;
}

Json cells_json(const CellTable& table) {
  Json rows = Json::array();
  for (const CellErrors& c : table.cells)
    rows.push_back({{"x0", c.cell.x0},
                    {"y0", c.cell.y0},
                    {"x1", c.cell.x1},
                    {"y1", c.cell.y1},
                    {"mean", c.mean},
                    {"percentile_99", c.percentile_99},
                    {"worst_block", c.worst_block}});
  return rows;
}

// The figures by key, and what else differs from frame to frame.
Json frame_json(const FrameReport& r) {
  Json j;
  for (const Figure& f : r.figures) j[f.key] = f.value;
  j["tile"] = {r.tile.width, r.tile.height};
  j["not_finite"] = {{"image", r.image.not_finite}, {"reference", r.reference.not_finite}};
  if (!r.image.origin.empty()) j["image"] = json(r.image);
  if (!r.reference.origin.empty()) j["reference"] = json(r.reference);
  for (const CellTable& table : r.cells) j["cells"][table.metric] = cells_json(table);
  for (const WrittenMap& m : r.maps)
    j["maps"].push_back({{"metric", m.metric}, {"file", m.file.string()}, {"low", 0}, {"high", m.high}});
  return j;
}

Json domains_json(const std::vector<Figure>& figures) {
  Json j;
  for (const Figure& f : figures) j[f.key] = beside(f);
  return j;
}

Json heading_json(const FrameReport& r) {
  return {{"width", r.region.width()},
          {"height", r.region.height()},
          {"display", to_string(r.display.curve)},
          {"exposure", r.display.exposure}};
}

Json json(const FrameReport& r) {
  Json j = heading_json(r);
  j.update(frame_json(r));
  j["domains"] = domains_json(r.figures);
  return j;
}

Json json(const SequenceReport& s) {
  Json j = heading_json(s.frames.front());
  std::vector<Figure> all;
  for (const Summary& one : summaries(s)) {
    all.push_back(one.figure);
    j["mean"][one.figure.key] = one.mean;
    j["worst"][one.figure.key] = {{"value", one.worst}, {"frame", one.worst_frame}};
  }
  for (const Figure& f : s.over_frames) {
    all.push_back(f);
    j["over_frames"][f.key] = f.value;
  }
  j["domains"] = domains_json(all);
  for (const FrameReport& frame : s.frames) {
    Json one{{"frame", frame.frame}};
    one.update(frame_json(frame));
    j["frames"].push_back(std::move(one));
  }
  return j;
}

// CSV: one figure a row, with what it is of. Remarks are ours and hold no quotes.

constexpr std::string_view kCsvHead =
    "scope,frame,x0,y0,x1,y1,metric,statistic,value,domain,exposure,remark\n";

void write_row(std::ostream& out, std::string_view scope, const std::string& frame, const Region& r,
               std::string_view metric, std::string_view statistic, double value, const Figure& of) {
  out << fmt::format("{},{},{},{},{},{},{},{},{:.9g},{},{},\"{}\"\n", scope, frame, r.x0, r.y0, r.x1, r.y1,
                     metric, statistic, unsigned_nan(value), of.domain,
                     of.exposure ? fmt::format("{:g}", *of.exposure) : "", of.remark);
}

void write_csv(std::ostream& out, const FrameReport& r, const std::string& frame) {
  for (const Figure& f : r.figures) write_row(out, "image", frame, r.region, f.key, "value", f.value, f);
  for (const CellTable& table : r.cells)
    for (const CellErrors& c : table.cells) {
      write_row(out, "cell", frame, c.cell, table.metric, "mean", c.mean, table.of);
      write_row(out, "cell", frame, c.cell, table.metric, "percentile_99", c.percentile_99, table.of);
      write_row(out, "cell", frame, c.cell, table.metric, "worst_block", c.worst_block, table.of);
    }
}

void write_csv(std::ostream& out, const SequenceReport& s) {
  for (const FrameReport& frame : s.frames) write_csv(out, frame, fmt::format("{}", frame.frame));
  const Region& region = s.frames.front().region;
  for (const Summary& one : summaries(s)) {
    write_row(out, "sequence", "", region, one.figure.key, "mean", one.mean, one.figure);
    write_row(out, "sequence", fmt::format("{}", one.worst_frame), region, one.figure.key, "worst", one.worst,
              one.figure);
  }
  for (const Figure& f : s.over_frames) write_row(out, "sequence", "", region, f.key, "value", f.value, f);
}

bool worse(const Figure& f, double than) {
  if (std::isnan(than)) return false;
  return std::isnan(f.value) || (f.higher_is_better ? f.value < than : f.value > than);
}

}  // namespace

std::vector<Summary> summaries(const SequenceReport& s) {
  std::vector<Summary> all;
  std::vector<double> frames;
  for (const FrameReport& frame : s.frames)
    for (const Figure& f : frame.figures) {
      auto at = std::ranges::find(all, f.key, [](const Summary& one) { return one.figure.key; });
      if (at == all.end()) {
        at = all.insert(all.end(), {f, 0, f.value, frame.frame});
        frames.push_back(0);
      }
      ++frames[static_cast<std::size_t>(at - all.begin())];
      at->mean += f.value;
      if (worse(f, at->worst)) at->worst = f.value, at->worst_frame = frame.frame;
      if (f.remark != at->figure.remark) at->figure.remark.clear();
    }
  for (std::size_t i = 0; i < all.size(); ++i) all[i].mean /= frames[i];
  return all;
}

void write(std::ostream& out, const FrameReport& r, Format format) {
  if (format == Format::text) write_text(out, r);
  if (format == Format::json) out << json(r).dump(2) << '\n';
  if (format == Format::csv) write_csv(out << kCsvHead, r, "");
}

void write(std::ostream& out, const SequenceReport& s, Format format) {
  if (format == Format::text) write_text(out, s);
  if (format == Format::json) out << json(s).dump(2) << '\n';
  if (format == Format::csv) write_csv(out << kCsvHead, s);
}

}  // namespace tessera
