// SPDX-License-Identifier: Apache-2.0
#include "bench/judging/plot.h"

#include <OpenImageIO/imagebufalgo.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/judging/sheet.h"
#include "core/error.h"

namespace tessera::judging {
namespace {

// Drawn at twice the size, for the lines come without smooth edges.
constexpr int kScale = 2;
constexpr int kWidth = 1040 * kScale, kHeight = 480 * kScale;
constexpr int kLeft = 80 * kScale, kRight = kWidth - 340 * kScale, kTop = 50 * kScale,
              kBottom = kHeight - 50 * kScale;
constexpr int kLetters = 13 * kScale, kDash = 8 * kScale;
constexpr int kMarks = 8;  // along an axis

struct Rgb {
  float r, g, b;
};
constexpr Rgb kBlack{0, 0, 0}, kGrey{0.85f, 0.85f, 0.85f};
constexpr Rgb kColors[] = {{0.00f, 0.00f, 0.00f}, {0.90f, 0.62f, 0.00f}, {0.34f, 0.71f, 0.91f},
                           {0.00f, 0.62f, 0.45f}, {0.80f, 0.72f, 0.00f}, {0.00f, 0.45f, 0.70f},
                           {0.84f, 0.37f, 0.00f}, {0.80f, 0.47f, 0.65f}};

bool shown(const Point& p, bool logarithmic) {
  return std::isfinite(p.x) && std::isfinite(p.y) && (!logarithmic || p.y > 0);
}

// Where numbers come to lie; y as it is, or its logarithm.
struct Axes {
  double x0 = 0, x1 = 1, y0 = 0, y1 = 1;
  bool logarithmic = false;

  int across(double x) const {
    return kLeft + static_cast<int>(std::lround((x - x0) / (x1 - x0) * (kRight - kLeft)));
  }
  int down(double y) const {
    const double v = logarithmic ? std::log10(y) : y;
    return kBottom - static_cast<int>(std::lround((v - y0) / (y1 - y0) * (kBottom - kTop)));
  }
};

Axes axes_of(const Plot& plot) {
  std::vector<double> xs, ys;
  for (const Line& line : plot.lines)
    for (const Point& p : line.points)
      if (shown(p, plot.logarithmic)) {
        xs.push_back(p.x);
        ys.push_back(plot.logarithmic ? std::log10(p.y) : p.y);
      }
  if (xs.empty()) return {.logarithmic = plot.logarithmic};
  const auto [left, right] = std::ranges::minmax(xs);
  auto [low, high] = std::ranges::minmax(ys);
  if (!plot.logarithmic) low = std::min(low, 0.0);
  const double room = high > low ? 0.05 * (high - low) : 1;
  return {left, right > left ? right : left + 1, low < 0 || plot.logarithmic ? low - room : low, high + room,
          plot.logarithmic};
}

class Sheet {
 public:
  Sheet() : pixels_(OIIO::ImageSpec(kWidth, kHeight, 3, OIIO::TypeDesc::FLOAT)) {
    OIIO::ImageBufAlgo::fill(pixels_, {1.0f, 1.0f, 1.0f});
  }

  void line(int x0, int y0, int x1, int y1, const Rgb& color, int width = kScale) {
    const bool steep = std::abs(y1 - y0) > std::abs(x1 - x0);
    for (int i = 0; i < width; ++i) {
      const int aside = i - width / 2, dx = steep ? aside : 0, dy = steep ? 0 : aside;
      OIIO::ImageBufAlgo::render_line(pixels_, x0 + dx, y0 + dy, x1 + dx, y1 + dy,
                                      {color.r, color.g, color.b});
    }
  }

  using Align = OIIO::ImageBufAlgo::TextAlignX;
  void text(int x, int y, const std::string& words, Align align = Align::Left) {
    OIIO::ImageBufAlgo::render_text(pixels_, x, y, words, kLetters, std::string(kFont), {0.0f, 0.0f, 0.0f},
                                    align, OIIO::ImageBufAlgo::TextAlignY::Center);
  }

  // Dashes go on from one piece to the next.
  void curve(const std::vector<std::pair<int, int>>& places, const Rgb& color, bool dashed) {
    double gone = 0;
    for (std::size_t i = 1; i < places.size(); ++i) {
      const auto [x0, y0] = places[i - 1];
      const auto [x1, y1] = places[i];
      const double length = std::hypot(x1 - x0, y1 - y0);
      const int steps = dashed ? std::max(1, static_cast<int>(length / (kDash / 4))) : 1;
      for (int s = 0; s < steps; ++s) {
        const double t0 = double(s) / steps, t1 = double(s + 1) / steps;
        if (!dashed || std::fmod(gone + t0 * length, 2 * kDash) < kDash)
          line(static_cast<int>(std::lround(std::lerp(x0, x1, t0))),
               static_cast<int>(std::lround(std::lerp(y0, y1, t0))),
               static_cast<int>(std::lround(std::lerp(x0, x1, t1))),
               static_cast<int>(std::lround(std::lerp(y0, y1, t1))), color, 2 * kScale);
      }
      gone += length;
    }
  }

  void write(const std::filesystem::path& file) {
    OIIO::ImageBuf small(OIIO::ImageSpec(kWidth / kScale, kHeight / kScale, 3, OIIO::TypeDesc::FLOAT));
    OIIO::ImageBufAlgo::resize(small, pixels_, "box");
    if (!small.write(file.string(), OIIO::TypeDesc::UINT8))
      throw InputError(file.string(), "cannot be written: " + small.geterror(), "a writable folder");
  }

 private:
  OIIO::ImageBuf pixels_;
};

std::string number(double v) { return fmt::format("{:.4g}", std::abs(v) < 1e-12 ? 0.0 : v); }

// Powers of ten within the axis, and if they are few, 2 and 5 times those.
std::vector<double> powers(double low, double high) {
  std::vector<double> marks;
  for (int e = static_cast<int>(std::floor(low)); e <= static_cast<int>(std::ceil(high)); ++e)
    for (const double m : {1.0, 2.0, 5.0}) {
      const double v = std::log10(m) + e;
      if (v >= low && v <= high && (m == 1 || high - low < 3)) marks.push_back(m * std::pow(10.0, e));
    }
  return marks;
}

void draw_axes(Sheet& sheet, const Plot& plot, const Axes& axes) {
  for (const double y : axes.logarithmic ? powers(axes.y0, axes.y1) : ticks(axes.y0, axes.y1, kMarks)) {
    sheet.line(kLeft, axes.down(y), kRight, axes.down(y), kGrey);
    sheet.text(kLeft - 8 * kScale, axes.down(y), number(y), Sheet::Align::Right);
  }
  for (const double x : ticks(axes.x0, axes.x1, kMarks)) {
    sheet.line(axes.across(x), kBottom, axes.across(x), kBottom + 5 * kScale, kBlack);
    sheet.text(axes.across(x), kBottom + 16 * kScale, number(x), Sheet::Align::Center);
  }
  sheet.line(kLeft, kTop, kLeft, kBottom, kBlack);
  sheet.line(kLeft, kBottom, kRight, kBottom, kBlack);
  sheet.text((kLeft + kRight) / 2, 14 * kScale, plot.title, Sheet::Align::Center);
  sheet.text((kLeft + kRight) / 2, kHeight - 14 * kScale, plot.x, Sheet::Align::Center);
  sheet.text(10 * kScale, kTop - 16 * kScale, plot.y);
}

}  // namespace

std::vector<double> ticks(double low, double high, int count) {
  const double wanted = (high - low) / count, power = std::pow(10.0, std::floor(std::log10(wanted)));
  double step = 10 * power;
  for (const double m : {5.0, 2.0, 1.0})
    if (m * power >= wanted * (1 - 1e-9)) step = m * power;
  std::vector<double> marks;
  const double first = std::ceil(low / step - 1e-9), last = std::floor(high / step + 1e-9);
  for (double i = first; i <= last; ++i) marks.push_back(i * step);
  return marks;
}

void write_plot(const std::filesystem::path& file, const Plot& plot) {
  const Axes axes = axes_of(plot);
  Sheet sheet;
  draw_axes(sheet, plot, axes);
  int row = kTop + 10 * kScale;
  for (const Line& line : plot.lines) {
    const Rgb& color = kColors[static_cast<std::size_t>(line.color) % std::size(kColors)];
    std::vector<std::pair<int, int>> places;
    for (const Point& p : line.points)
      if (shown(p, plot.logarithmic)) places.emplace_back(axes.across(p.x), axes.down(p.y));
    sheet.curve(places, color, line.dashed);
    const int x = kRight + 16 * kScale;
    sheet.curve({{x, row}, {x + 36 * kScale, row}}, color, line.dashed);
    sheet.text(x + 42 * kScale, row, line.name);
    row += 20 * kScale;
  }
  sheet.write(file);
}

}  // namespace tessera::judging
