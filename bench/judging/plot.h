// SPDX-License-Identifier: Apache-2.0
// Lines over a pair of axes, with a legend, as PNG.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tessera::judging {

struct Point {
  double x = 0, y = 0;
};

struct Line {
  std::string name;
  std::vector<Point> points;  // in the order of x; those that are not finite are left out
  bool dashed = false;
  int color =
      0;  // of a table of 8 that the colour-blind can tell apart (Okabe and Ito 2008), modulo its size
};

struct Plot {
  std::string title, x, y;   // above; below the horizontal axis; above the vertical one
  bool logarithmic = false;  // the vertical axis: what is not above 0 is left out
  std::vector<Line> lines;
};

// The marks of an axis from `low` to `high`: 1, 2 or 5 times a power of ten apart, some `count` of them.
std::vector<double> ticks(double low, double high, int count);

// Without the font (bench/judging/sheet.h) there are no words. Throws InputError if it cannot be written.
void write_plot(const std::filesystem::path& file, const Plot& plot);

}  // namespace tessera::judging
