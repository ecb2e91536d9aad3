// SPDX-License-Identifier: Apache-2.0
#include "bench/judging/sheet.h"

#include <OpenImageIO/imagebufalgo.h>

#include <algorithm>

#include "core/png.h"

namespace tessera::judging {
namespace {

constexpr int kGap = 4, kStrip = 18, kLetters = 12;  // pixels

// Copies all of `source` to where its region's corner comes to lie at (x, y).
void put(Image& target, const Image& source, int x, int y) {
  for (int c = 0; c < 3; ++c)
    for (int row = 0; row < source.region().height(); ++row)
      std::ranges::copy(source.row(c, source.region().y0 + row), target.row(c, y + row).begin() + x);
}

}  // namespace

Image in_rows(const std::vector<Image>& pictures, int columns) {
  const auto wide = static_cast<std::size_t>(columns);
  std::vector<Image> rows;
  for (std::size_t i = 0; i < pictures.size(); i += wide) {
    std::vector<Image> row(
        pictures.begin() + static_cast<std::ptrdiff_t>(i),
        pictures.begin() + static_cast<std::ptrdiff_t>(std::min(i + wide, pictures.size())));
    while (row.size() < wide) row.emplace_back(pictures[0].region(), 3, 1.0f);
    rows.push_back(side_by_side(row, kGap));
  }
  const Region r = rows[0].region();
  Image whole({0, 0, r.width(), (r.height() + kGap) * static_cast<int>(rows.size()) - kGap}, 3, 1.0f);
  for (std::size_t i = 0; i < rows.size(); ++i)
    put(whole, rows[i], 0, static_cast<int>(i) * (r.height() + kGap));
  return whole;
}

Image captioned(const Image& picture, const std::string& text) {
  const int width = picture.region().width(), height = picture.region().height();
  OIIO::ImageBuf strip(OIIO::ImageSpec(width, kStrip, 3, OIIO::TypeDesc::FLOAT));
  OIIO::ImageBufAlgo::fill(strip, {1.0f, 1.0f, 1.0f});
  OIIO::ImageBufAlgo::render_text(strip, 2, kStrip - 5, text, kLetters, std::string(kFont),
                                  {0.0f, 0.0f, 0.0f});
  Image whole({0, 0, width, kStrip + height}, 3, 1.0f);
  for (OIIO::ImageBuf::ConstIterator<float> p(strip); !p.done(); ++p)
    for (int c = 0; c < 3; ++c) whole.at(c, p.x(), p.y()) = p[c];
  put(whole, picture, 0, kStrip);
  return whole;
}

Image enlarged(const Image& picture, int factor) {
  const Region r = picture.region();
  Image large({0, 0, factor * r.width(), factor * r.height()}, 3);
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < large.region().y1; ++y)
      for (int x = 0; x < large.region().x1; ++x)
        large.at(c, x, y) = picture.at(c, r.x0 + x / factor, r.y0 + y / factor);
  return large;
}

}  // namespace tessera::judging
