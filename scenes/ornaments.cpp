// SPDX-License-Identifier: Apache-2.0
#include "scenes/ornaments.h"

namespace tessera::scenes {

Shape column() {
  return lathe({{0.25f, 0},     {0.25f, 0.14f}, {0.25f, 0.14f},  {0.23f, 0.17f},  {0.245f, 0.21f},
                {0.22f, 0.26f}, {0.17f, 0.29f}, {0.165f, 0.32f}, {0.167f, 0.9f},  {0.155f, 1.5f},
                {0.14f, 1.98f}, {0.14f, 1.98f}, {0.165f, 2.0f},  {0.165f, 2.04f}, {0.145f, 2.06f},
                {0.15f, 2.10f}, {0.20f, 2.18f}, {0.25f, 2.24f},  {0.26f, 2.27f},  {0.26f, 2.27f},
                {0.27f, 2.27f}, {0.27f, 2.27f}, {0.27f, 2.35f},  {0.27f, 2.35f},  {0.0f, 2.35f}},
               40);
}

Shape lantern() {
  Shape shape = lathe({{0.008f, kGlobe + 0.9f * kGlobeRadius}, {0.008f, 0}}, 8);
  shape.add(lathe({{0.06f, kGlobe + 0.9f * kGlobeRadius},
                   {0.05f, kGlobe + 1.1f * kGlobeRadius},
                   {0.02f, kGlobe + 1.3f * kGlobeRadius},
                   {0.0f, kGlobe + 1.4f * kGlobeRadius}},
                  24));
  return shape;
}

Shape rosette() {
  Shape shape;
  Dice dice(7);
  for (int i = 0; i < 34; ++i) {
    const float rise = 0.25f + 1.15f * static_cast<float>(i) / 34, around = 2.399963f * static_cast<float>(i);
    Matrix tilt, turn;
    tilt.setAxisAngle(Vec3(1, 0, 0), -rise);
    turn.setAxisAngle(Vec3(0, 1, 0), around);
    shape.add(leaf(0.62f * dice.between(0.85f, 1.1f), 0.13f, 0.12f), tilt * turn);
  }
  return shape;
}

}  // namespace tessera::scenes
