// SPDX-License-Identifier: Apache-2.0
#include "core/filter/stand_ins.h"

#include <algorithm>
#include <cmath>

#include "core/aov.h"

namespace tessera {
namespace {

constexpr float kFarthest = 1e10f;
constexpr float kMostMotion = 1e6f;  // pixels

// The response at (x, y), the picture continued by its border pixels; scaled to the standard deviation of
// noise.
double response(const Image& picture, int plane, int x, int y) {
  constexpr int kMask[3][3] = {{1, -2, 1}, {-2, 4, -2}, {1, -2, 1}};
  const Region& r = picture.region();
  double sum = 0;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i)
      sum += kMask[j + 1][i + 1] *
             double(picture.at(plane, std::clamp(x + i, r.x0, r.x1 - 1), std::clamp(y + j, r.y0, r.y1 - 1)));
  return std::isfinite(sum) ? sum / 6 : 0;
}

// Means over 7 along each row, then along each column, of what lies in the picture.
void average(Image& image, int plane) {
  const Region& r = image.region();
  for (const bool along_x : {true, false}) {
    Image to(r, 1);
    for (int y = r.y0; y < r.y1; ++y)
      for (int x = r.x0; x < r.x1; ++x) {
        double sum = 0;
        int count = 0;
        for (int k = -3; k <= 3; ++k) {
          const int qx = along_x ? x + k : x, qy = along_x ? y : y + k;
          if (!r.contains(qx, qy)) continue;
          sum += image.at(plane, qx, qy);
          ++count;
        }
        to.at(0, x, y) = static_cast<float>(sum / count);
      }
    std::ranges::copy(to.data(), image.plane(plane).begin());
  }
}

// Of the two, the one that is nearer to 0; NaN is none.
float smaller(float a, float b) {
  if (!std::isfinite(a)) return std::isfinite(b) ? b : 0;
  return std::isfinite(b) && std::abs(b) < std::abs(a) ? b : a;
}

}  // namespace

Image estimated_variance(const Image& picture) {
  Image variance(picture.region(), picture.planes());
  const Region& r = picture.region();
  for (int p = 0; p < picture.planes(); ++p) {
    for (int y = r.y0; y < r.y1; ++y)
      for (int x = r.x0; x < r.x1; ++x) {
        const double noise = response(picture, p, x, y);
        variance.at(p, x, y) = static_cast<float>(std::min(noise * noise, 1e30));
      }
    average(variance, p);
  }
  return variance;
}

Image depth_differences(const Image& depth) {
  const Region& r = depth.region();
  Image slope(r, 2);
  const auto at = [&](int x, int y) {
    return r.contains(x, y) && depth.at(0, x, y) < kSkyDepth ? depth.at(0, x, y) : NAN;
  };
  for (int y = r.y0; y < r.y1; ++y)
    for (int x = r.x0; x < r.x1; ++x) {
      const float here = at(x, y);
      slope.at(0, x, y) = smaller(at(x + 1, y) - here, here - at(x - 1, y));
      slope.at(1, x, y) = smaller(at(x, y + 1) - here, here - at(x, y - 1));
    }
  return slope;
}

void mark_sky(std::span<float> depth) {
  for (float& z : depth)
    if (!(std::abs(z) < kFarthest)) z = kSkyDepth;
}

BrokenPixels mend_motion(std::array<std::span<float>, 2> motion) {
  BrokenPixels broken;
  for (std::size_t i = 0; i < motion[0].size(); ++i) {
    float &x = motion[0][i], &y = motion[1][i];
    if (std::abs(x) <= kMostMotion && std::abs(y) <= kMostMotion) continue;
    const bool nowhere = std::abs(x) == kSkyDepth && std::abs(y) == kSkyDepth;
    if (!nowhere && broken.count++ == 0) broken.first = i;
    x = y = kSkyDepth;
  }
  return broken;
}

}  // namespace tessera
