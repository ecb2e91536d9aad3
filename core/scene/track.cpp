// SPDX-License-Identifier: Apache-2.0
#include "core/scene/track.h"

#include <Imath/ImathMatrixAlgo.h>

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

using Imath::M33d;
using Imath::Quatd;
using Parts = Movement::Parts;

// Below this share of the largest, a singular value is rounding.
constexpr double kFlat = 1e-6;

M33d linear(const Matrix& m) {
  M33d l;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) l[i][k] = m[i][k];
  return l;
}

// The rotation in m; false if m leaves nothing of it.
bool rotation_of(const M33d& m, M33d& rotation) {
  M33d u, v;
  Imath::V3d s;
  Imath::jacobiSVD(m, u, s, v);  // m = u diag(s) v^T, values falling
  if (!(s.y > kFlat * s.x)) return false;
  if (u.determinant() * v.determinant() < 0) {
    // A plane has two: take the proper one. Of a mirror the stretch turns things over, not the rotation.
    if (s.z > kFlat * s.x)
      u *= -1.0;
    else
      for (int i = 0; i < 3; ++i) u[i][2] = -u[i][2];
  }
  rotation = u * v.transposed();
  return true;
}

Quatd quaternion(const M33d& r) {
  const Imath::M44d m(r, Imath::V3d(0, 0, 0));
  return Imath::extractQuat(m).normalized();
}

Parts parts(const Matrix& m, const M33d& rotation) {
  return {linear(m) * rotation.transposed(), quaternion(rotation), Imath::V3d(m[3][0], m[3][1], m[3][2])};
}

std::pair<Parts, Parts> segment(const Matrix& from, const Matrix& to) {
  M33d a, b;
  const bool has_a = rotation_of(linear(from), a), has_b = rotation_of(linear(to), b);
  if (!has_a && has_b) a = b;
  if (!has_b && has_a) b = a;
  return {parts(from, a), parts(to, b)};
}

Matrix between(const Parts& a, const Parts& b, double t) {
  const M33d stretch = a.stretch * (1 - t) + b.stretch * t;
  const M33d l = stretch * Imath::slerpShortestArc(a.rotation, b.rotation, t).toMatrix33();
  const Imath::V3d at = a.translation * (1 - t) + b.translation * t;
  Matrix m;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) m[i][k] = static_cast<float>(l[i][k]);
    m[3][i] = static_cast<float>(at[i]);
  }
  return m;
}

// The key at or before a time, and how far it is to the next; at a key or outside of all, 0.
struct Place {
  std::size_t key;
  double share;
};
Place place(const Track& track, double seconds) {
  const auto& times = track.times;
  const auto after = std::upper_bound(times.begin(), times.end(), seconds);
  if (after == times.begin()) return {0, 0};
  const auto key = static_cast<std::size_t>(after - times.begin()) - 1;
  if (after == times.end()) return {key, 0};
  return {key, (seconds - times[key]) / (double(*after) - times[key])};
}

// Nothing to interpolate: the key itself, to the bit.
bool rests(const Track& track, const Place& p) {
  return p.share == 0 || track.poses[p.key] == track.poses[p.key + 1];
}

}  // namespace

Matrix pose(const Track& track, double seconds) {
  const Place p = place(track, seconds);
  if (rests(track, p)) return track.poses[p.key];
  const auto [from, to] = segment(track.poses[p.key], track.poses[p.key + 1]);
  return between(from, to, p.share);
}

Movement::Movement(Track track) : track_(std::move(track)) {
  for (std::size_t i = 0; i + 1 < track_.poses.size(); ++i) {
    const auto [from, to] = segment(track_.poses[i], track_.poses[i + 1]);
    segments_.push_back({from, to});
  }
}

Matrix Movement::at(double seconds) const {
  const Place p = place(track_, seconds);
  if (rests(track_, p)) return track_.poses[p.key];
  return between(segments_[p.key].from, segments_[p.key].to, p.share);
}

}  // namespace tessera
