// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/animation.h"

#include <Imath/ImathMatrixAlgo.h>
#include <Imath/ImathQuat.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/scene/sampled_track.h"

namespace tessera::gltf {
namespace {

constexpr double kTolerance = 1e-3;                      // of the whole movement
constexpr std::size_t kMaxPoses = std::size_t{1} << 22;  // of all tracks: 256 MiB
constexpr int kMaxHalvings = 8;                          // of the time between two keys
// Hidden things are often scaled to nothing; what stays is too small to see, and can be inverted.
constexpr double kSmallestScale = 1e-6;

MatrixD composed(const Imath::V3d& scale, const Imath::Quatd& rotation, const Imath::V3d& translation) {
  MatrixD scaled, moved;
  scaled.setScale(scale);
  moved.setTranslation(translation);
  return scaled * rotation.normalized().toMatrix44() * moved;
}

Imath::Quatd quaternion(const std::array<double, 4>& v) { return {v[3], v[0], v[1], v[2]}; }

// Without scale, as a camera stands.
MatrixD without_scale(const MatrixD& m) {
  const Imath::V3d z = Imath::V3d(m[2][0], m[2][1], m[2][2]).normalized();
  const Imath::V3d x = Imath::V3d(m[1][0], m[1][1], m[1][2]).cross(z).normalized(), y = z.cross(x);
  return {x.x, x.y, x.z, 0, y.x, y.y, y.z, 0, z.x, z.y, z.z, 0, m[3][0], m[3][1], m[3][2], 1};
}

}  // namespace

MatrixD rest_transform(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) {
    MatrixD m;
    for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = node.matrix[static_cast<std::size_t>(i)];
    return m;
  }
  const auto vector = [](const std::vector<double>& v, double otherwise) {
    return v.size() == 3 ? Imath::V3d(v[0], v[1], v[2]) : Imath::V3d(otherwise);
  };
  const std::vector<double>& r = node.rotation;
  return composed(vector(node.scale, 1),
                  r.size() == 4 ? Imath::Quatd(r[3], r[0], r[1], r[2]) : Imath::Quatd(),
                  vector(node.translation, 0));
}

Animations::Animations(Scene& scene, const Document& document)
    : scene_(scene), document_(document), movers_(document.model.nodes.size()) {
  for (std::size_t a = 0; a < document.model.animations.size(); ++a)
    read(document.model.animations[a], fmt::format("animations/{}", a));
}

void Animations::read(const tinygltf::Animation& animation, const std::string& part) {
  for (const tinygltf::AnimationChannel& channel : animation.channels) {
    if (channel.target_path == "weights") {
      document_.warn(scene_, "animations of morph targets are ignored");
      continue;
    }
    const std::size_t node = checked(document_, channel.target_node, movers_.size(),
                                     fmt::format("node {}", channel.target_node), part);
    auto read = read_channel(animation, channel, part);
    if (!read) continue;
    auto& channels = movers_[node];
    const bool taken = std::any_of(channels.begin(), channels.end(),
                                   [&](const Channel& c) { return c.property == read->property; });
    const std::string name = document_.model.nodes[node].name;
    if (taken)
      document_.warn(scene_,
                     fmt::format("the animation '{}' moves the node '{}' as one before it does: ignored",
                                 animation.name, name));
    else if (document_.model.nodes[node].matrix.size() == 16)
      document_.warn(scene_, fmt::format("the node '{}' has a matrix: its animation is ignored", name));
    else
      channels.push_back(std::move(*read));
  }
}

std::optional<Animations::Channel> Animations::read_channel(const tinygltf::Animation& animation,
                                                            const tinygltf::AnimationChannel& channel,
                                                            const std::string& part) {
  Channel result;
  if (channel.target_path == "translation")
    result.property = Property::translation;
  else if (channel.target_path == "rotation")
    result.property = Property::rotation;
  else if (channel.target_path == "scale")
    result.property = Property::scale;
  else
    return document_.warn(scene_, fmt::format("an animation of '{}' is ignored", channel.target_path)),
           std::nullopt;
  const auto& sampler = animation.samplers[checked(document_, channel.sampler, animation.samplers.size(),
                                                   fmt::format("sampler {}", channel.sampler), part)];
  if (sampler.interpolation == "LINEAR")
    result.interpolation = Interpolation::linear;
  else if (sampler.interpolation == "STEP")
    result.interpolation = Interpolation::step;
  else if (sampler.interpolation == "CUBICSPLINE")
    result.interpolation = Interpolation::cubic;
  else
    document_.refuse(part, fmt::format("the interpolation is '{}'", sampler.interpolation),
                     "LINEAR, STEP or CUBICSPLINE");
  result.times = floats_of(document_, sampler.input, {TINYGLTF_TYPE_SCALAR}).values;
  result.values =
      floats_of(document_, sampler.output,
                {result.property == Property::rotation ? TINYGLTF_TYPE_VEC4 : TINYGLTF_TYPE_VEC3});
  for (std::size_t t = 0; t < result.times.size(); ++t)
    if (!std::isfinite(result.times[t]) || (t > 0 && !(result.times[t] > result.times[t - 1])))
      document_.refuse(part, fmt::format("time {} of an animation is {}", t, result.times[t]),
                       "rising times");
  for (const float v : result.values.values)
    if (!std::isfinite(v)) document_.refuse(part, "a value of an animation is not finite");
  const std::size_t each = result.interpolation == Interpolation::cubic ? 3 : 1;
  if (result.values.count() != each * result.times.size())
    document_.refuse(
        part,
        fmt::format("an animation has {} values for {} times", result.values.count(), result.times.size()),
        fmt::format("{} a time", each));
  return result;
}

// glTF 2.0, appendix C: linear, spherical linear and cubic interpolation.
std::array<double, 4> Animations::value_at(const Channel& channel, double seconds) {
  const auto& times = channel.times;
  const auto width = static_cast<std::size_t>(channel.values.width);
  const bool cubic = channel.interpolation == Interpolation::cubic;
  const auto key = [&](std::size_t k, std::size_t which) {  // which of the three, if cubic
    const float* at = channel.values.at(cubic ? 3 * k + which : k);
    std::array<double, 4> value{};
    std::copy_n(at, width, value.begin());
    return value;
  };
  const auto next =
      static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), seconds) - times.begin());
  if (next == 0) return key(0, 1);
  if (next == times.size() || channel.interpolation == Interpolation::step) return key(next - 1, 1);
  const double span = double(times[next]) - times[next - 1], s = (seconds - times[next - 1]) / span;
  const auto a = key(next - 1, 1), b = key(next, 1);
  std::array<double, 4> value{};
  if (!cubic && channel.property == Property::rotation) {
    const Imath::Quatd q = Imath::slerpShortestArc(quaternion(a).normalized(), quaternion(b).normalized(), s);
    return {q.v.x, q.v.y, q.v.z, q.r};
  }
  const auto out = key(next - 1, 2), in = key(next, 0);
  const double s2 = s * s, s3 = s2 * s;
  for (std::size_t c = 0; c < width; ++c)
    value[c] = cubic ? (2 * s3 - 3 * s2 + 1) * a[c] + span * (s3 - 2 * s2 + s) * out[c] +
                           (3 * s2 - 2 * s3) * b[c] + span * (s3 - s2) * in[c]
                     : (1 - s) * a[c] + s * b[c];
  return value;
}

MatrixD Animations::transform_at(int node, double seconds) const {
  const auto index = static_cast<std::size_t>(node);
  if (!move(node)) return rest_transform(document_.model.nodes[index]);
  tinygltf::Node posed = document_.model.nodes[index];
  for (const Channel& channel : movers_[index]) {
    const auto v = value_at(channel, seconds);
    if (channel.property == Property::translation) posed.translation = {v[0], v[1], v[2]};
    if (channel.property == Property::rotation) posed.rotation = {v[0], v[1], v[2], v[3]};
    if (channel.property == Property::scale) {
      posed.scale = {v[0], v[1], v[2]};
      for (double& s : posed.scale)
        if (std::abs(s) < kSmallestScale) s = std::copysign(kSmallestScale, s);
    }
  }
  return rest_transform(posed);
}

MatrixD Animations::world_at(const std::vector<int>& path, double seconds, bool rigid) const {
  MatrixD world;
  for (const int node : path) world = transform_at(node, seconds) * world;
  return rigid ? without_scale(world) : world;
}

// Of all nodes on the path. A step is two times next to each other.
std::set<float> Animations::key_times(const std::vector<int>& path) const {
  std::set<float> times;
  for (const int node : path)
    for (const Channel& channel : movers_[static_cast<std::size_t>(node)])
      for (std::size_t t = 0; t < channel.times.size(); ++t) {
        times.insert(channel.times[t]);
        if (t > 0 && channel.interpolation == Interpolation::step)
          times.insert(std::nextafter(channel.times[t], -INFINITY));
      }
  return times;
}

int Animations::add_track(const std::vector<int>& path, bool rigid) {
  const auto pose = [&](double seconds) { return world_at(path, seconds, rigid); };
  scene_.tracks.push_back(sampled_track(key_times(path), pose, {kTolerance, kMaxHalvings}));
  poses_ += scene_.tracks.back().times.size();
  require_at_most(kMaxPoses, poses_, "poses in all tracks", document_.file.string());
  return static_cast<int>(scene_.tracks.size()) - 1;
}

}  // namespace tessera::gltf
