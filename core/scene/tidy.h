// SPDX-License-Identifier: Apache-2.0
// Makes an imported mesh one that can be rendered: finite numbers, unit normals, triangles with an area.
#pragma once

#include <cstdint>

#include "core/scene/scene.h"

namespace tessera {

// Coordinates beyond this are taken for garbage: their squares must stay finite floats. Metres.
inline constexpr float kMaxCoordinate = 1e12f;
inline constexpr std::size_t kMaxIndices = std::size_t{1} << 31;  // of one mesh

// What tidying took away.
struct Tidied {
  std::size_t not_finite = 0;  // triangles with a vertex that is NaN, infinite or beyond kMaxCoordinate
  std::size_t degenerate = 0;  // triangles without an area
  std::size_t colors = 0;      // vertex colours that were not 0..1
};

// Needs indices in range. Normals that are no directions are replaced by that of a triangle at the vertex,
// texture coordinates that are not finite by 0; colours are clamped, NaN is 1.
Tidied tidy(Mesh& mesh);

}  // namespace tessera
