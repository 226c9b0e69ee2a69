#include "canonpose/export/body_shapes.h"

#include <cmath>
#include <numbers>

#include "canonpose/motion/body_measures.h"

namespace canonpose {
namespace {

using Eigen::Vector3d;

constexpr int kAround = 12;  // vertices of a ring
constexpr int kRings = 4;    // of each half sphere, its pole being one

/// Two half spheres and what is between them.
void AddCapsule(const Vector3d& from, const Vector3d& to, double from_radius, double to_radius, int joint,
                BodyMesh& mesh) {
  Vector3d axis = to - from;
  axis = axis.norm() > 1e-6 ? Vector3d(axis.normalized()) : Vector3d(Vector3d::UnitZ());
  const Vector3d side = axis.unitOrthogonal();
  const Vector3d other = axis.cross(side);
  const auto first = static_cast<std::uint32_t>(mesh.positions_mm.size());
  for (int ring = 0; ring < 2 * kRings; ++ring) {
    const bool is_start = ring < kRings;
    // From the pole at the start over both equators to the pole at the end.
    const double latitude = 0.5 * std::numbers::pi * (is_start ? ring - kRings + 1 : ring - kRings) / (kRings - 1);
    for (int i = 0; i < kAround; ++i) {
      const double longitude = 2.0 * std::numbers::pi * i / kAround;
      const Vector3d normal =
          std::sin(latitude) * axis + std::cos(latitude) * (std::cos(longitude) * side + std::sin(longitude) * other);
      mesh.positions_mm.push_back(is_start ? from + from_radius * normal : to + to_radius * normal);
      mesh.normals.push_back(normal.normalized());
      mesh.joints.push_back(joint);
    }
  }
  for (std::uint32_t ring = 0; ring + 1 < 2 * kRings; ++ring) {
    for (std::uint32_t i = 0; i < kAround; ++i) {
      const std::uint32_t next = (i + 1) % kAround;
      const std::uint32_t a = first + ring * kAround + i;
      const std::uint32_t b = first + ring * kAround + next;
      // Outwards is where the corners run counterclockwise. At a pole, one of the two triangles has no area.
      if (ring > 0) mesh.indices.insert(mesh.indices.end(), {a, b, a + kAround});
      if (ring + 2 < 2 * kRings) mesh.indices.insert(mesh.indices.end(), {b, b + kAround, a + kAround});
    }
  }
}

class ShapeBuilder {
 public:
  explicit ShapeBuilder(const HierarchyFit& fit) : fit_(fit), rest_(RestPose(fit.motion)) {
    index_.fill(-1);
    for (std::size_t j = 0; j < fit.roles.size(); ++j)
      index_[static_cast<std::size_t>(fit.roles[j])] = static_cast<int>(j);
  }

  std::array<BodyMesh, 3> Build() {
    AddTrunk();
    AddHead();
    for (int side = 0; side < 2; ++side) AddLimbs(side);
    return std::move(meshes_);
  }

 private:
  [[nodiscard]] const Vector3d& At(FittedJoint joint) const {
    return rest_[static_cast<std::size_t>(index_[static_cast<std::size_t>(joint)])];
  }
  BodyMesh& Mesh(BodySide side) { return meshes_[static_cast<std::size_t>(side)]; }

  /// A capsule that a joint moves; radii as shares of the stature.
  void Add(FittedJoint mover, const Vector3d& from, const Vector3d& to, double from_radius, double to_radius,
           BodySide side) {
    AddCapsule(from, to, from_radius * fit_.stature_mm, to_radius * fit_.stature_mm,
               index_[static_cast<std::size_t>(mover)], Mesh(side));
  }
  void AddBone(FittedJoint from, FittedJoint to, double from_radius, double to_radius, BodySide side) {
    Add(from, At(from), At(to), from_radius, to_radius, side);
  }

  void AddTrunk() {
    const Vector3d hips = At(kFLHip) - At(kFRHip);
    Add(kFHip, At(kFRHip) + 0.15 * hips, At(kFLHip) - 0.15 * hips, 0.052, 0.052, BodySide::kMiddle);
    AddBone(kFLumbar, kFSpine, 0.055, 0.056, BodySide::kMiddle);
    AddBone(kFSpine, kFChest, 0.056, 0.066, BodySide::kMiddle);
    const Vector3d height = At(kFThorax) - At(kFChest);
    const Vector3d shoulders = 0.2 * (At(kFLShoulder) - At(kFRShoulder));
    const Vector3d ribs = At(kFChest) + 0.55 * height;
    Add(kFChest, At(kFChest), ribs, 0.066, 0.06, BodySide::kMiddle);
    Add(kFChest, ribs - shoulders, ribs + shoulders, 0.05, 0.05, BodySide::kMiddle);
    AddBone(kFThorax, kFSkull, 0.03, 0.028, BodySide::kMiddle);
  }

  /// With a nose, which shows where it looks.
  void AddHead() {
    const Vector3d height = At(kFCrown) - At(kFSkull);
    const Vector3d middle = At(kFSkull) + 0.5 * height;
    const double radius = 0.5 * height.norm() / fit_.stature_mm;
    Add(kFSkull, middle, middle, radius, radius, BodySide::kMiddle);
    const Vector3d nose = middle - (radius + 0.012) * fit_.stature_mm * Vector3d::UnitY();
    Add(kFSkull, middle, nose, 0.014, 0.008, BodySide::kMiddle);
  }

  void AddLimbs(int side) {
    const BodySide colour = side == 0 ? BodySide::kLeft : BodySide::kRight;
    const auto bone = [&](FittedJoint from, FittedJoint to, double from_radius, double to_radius) {
      AddBone(OnSide(from, side), OnSide(to, side), from_radius, to_radius, colour);
    };
    bone(kFLClavicle, kFLShoulder, 0.028, 0.03);
    bone(kFLShoulder, kFLElbow, 0.027, 0.022);
    bone(kFLElbow, kFLWrist, 0.021, 0.015);
    bone(kFLWrist, kFLHandEnd, 0.018, 0.01);
    bone(kFLHip, kFLKnee, 0.045, 0.032);
    bone(kFLKnee, kFLAnkle, 0.031, 0.021);
    bone(kFLAnkle, kFLToes, 0.021, 0.017);
    bone(kFLToes, kFLBigToe, 0.017, 0.012);
  }

  const HierarchyFit& fit_;
  std::vector<Vector3d> rest_;
  std::array<int, kFittedJointCount> index_{};
  std::array<BodyMesh, 3> meshes_;
};

}  // namespace

std::array<BodyMesh, 3> MakeBodyShapes(const HierarchyFit& fit) { return ShapeBuilder(fit).Build(); }

}  // namespace canonpose
