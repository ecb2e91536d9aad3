// SPDX-License-Identifier: Apache-2.0
#include "core/error.h"
#include "core/scene/native/node.h"

namespace tessera {
namespace {

Matrix turn_of(const Node& node) {
  const auto rotate = node.find("rotate");
  Matrix x, y, z;
  if (!rotate) return x;
  if (rotate->json->is_object()) {
    x.setAxisAngle(rotate->direction("axis"), rotate->angle("degrees", 0));
    return x;
  }
  const auto degrees = [&](std::size_t axis) { return radians(rotate->json->items()[axis].number()); };
  x.setAxisAngle(Vec3(1, 0, 0), degrees(0));
  y.setAxisAngle(Vec3(0, 1, 0), degrees(1));
  z.setAxisAngle(Vec3(0, 0, 1), degrees(2));
  return x * y * z;
}

}  // namespace

Matrix read_transform(const Node& node) {
  if (node.has("matrix")) return node.matrix("matrix");
  const Json* scale = node.json->find("scale");
  Matrix s, move;
  s.setScale(scale ? as_vec3_or_number(*scale) : Vec3(1));
  move.setTranslation(node.point("translate", Vec3(0)));
  return s * turn_of(node) * move;
}

Matrix transform_of(const Node& node) {
  const auto transform = node.find("transform");
  return transform ? read_transform(*transform) : Matrix();
}

Matrix looking(const Node& look) {
  const Vec3 from = look.point("from", Vec3(0)), to = look.point("to", Vec3(0)),
             up = look.point("up", Vec3(0, 1, 0));
  const Vec3 back = (from - to).normalized();
  const Vec3 right = up.normalized().cross(back);
  if (from == to) throw InputError(look.where(), "`from` and `to` are the same point", "two points apart");
  if (right.length() < 1e-6f)
    throw InputError(look.where(), "`up` points along the view", "another direction");
  const Vec3 x = right.normalized(), y = back.cross(x);
  return {x.x, x.y, x.z, 0, y.x, y.y, y.z, 0, back.x, back.y, back.z, 0, from.x, from.y, from.z, 1};
}

Matrix then(const Matrix& a, const Matrix& b) {
  if (a == Matrix()) return b;
  return b == Matrix() ? a : a * b;
}

}  // namespace tessera
