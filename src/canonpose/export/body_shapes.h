// A body of simple shapes around a hierarchy in its rest pose, so that viewers have something to show.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "canonpose/motion/hierarchy_fit.h"

namespace canonpose {

enum class BodySide { kLeft, kRight, kMiddle };

/// Triangles that a hierarchy moves; each vertex is fixed to one joint.
struct BodyMesh {
  std::vector<Eigen::Vector3d> positions_mm;  ///< in the rest pose, z up, the root at the origin
  std::vector<Eigen::Vector3d> normals;
  std::vector<int> joints;  ///< of the motion
  std::vector<std::uint32_t> indices;
};

/// Capsules around the bones, by sides (BodySide).
std::array<BodyMesh, 3> MakeBodyShapes(const HierarchyFit& fit);

}  // namespace canonpose
