// What the solver estimates: the cameras, joints and bone lengths of a capture.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace canonpose {

/// A static camera, or a moving one in one frame. With x_in_camera = rotation * x_in_world + translation and f the
/// focal length in image diagonals, normalised image coordinates are f * (x, y) / z.
///
/// Of static cameras, `placement` is the translation. Where cameras move, the world is centred on the root joint in
/// every frame, and placement = (root x, root y, log scale) says where the root is seen and how large a unit appears
/// there: scale = f / depth of the root, so that translation = (x, y, f) / scale. The focal length then changes nothing
/// but the strength of perspective.
struct CameraEstimate {
  std::array<double, 4> quaternion{1, 0, 0, 0};  ///< camera_from_world; w, x, y, z
  std::array<double, 3> placement{0, 0, 0};      ///< translation, or (root x, root y, log scale)
  double log_focal = 0.0;
  bool valid = false;

  [[nodiscard]] Eigen::Matrix3d Rotation() const {
    return Eigen::Quaterniond(quaternion[0], quaternion[1], quaternion[2], quaternion[3])
        .normalized()
        .toRotationMatrix();
  }
  void SetRotation(const Eigen::Matrix3d& rotation) {
    const Eigen::Quaterniond q(rotation);
    quaternion = {q.w(), q.x(), q.y(), q.z()};
  }
  [[nodiscard]] double Focal() const { return std::exp(log_focal); }
};

/// F frames, V views, J joints. Lengths are in body units: the sum of all bone lengths is 1 (in the geometric
/// mean of the subjects, where a static capture shows several).
struct RigEstimate {
  bool static_cameras = true;
  int view_count = 0;
  int joint_count = 0;
  int first_frame = 0;                                ///< in the capture; not 0 in a slice of it
  std::vector<CameraEstimate> cameras;                ///< (V) static, (F, V) moving
  std::vector<Eigen::Vector3d> joints;                ///< (F, J) in the world; NaN where not solved
  std::vector<std::vector<double>> log_bone_lengths;  ///< (subjects, J) of the bone to the parent; the root's is unused

  /// An estimate in which nothing is known: joints and bone lengths are NaN, cameras not valid.
  static RigEstimate Unknown(bool static_cameras, int frames, int views, int joints, int subjects);

  [[nodiscard]] int frame_count() const { return static_cast<int>(joints.size()) / joint_count; }
  [[nodiscard]] CameraEstimate& CameraAt(int frame, int view) {
    return cameras[static_cast<std::size_t>(static_cameras ? view : (frame - first_frame) * view_count + view)];
  }
  [[nodiscard]] const CameraEstimate& CameraAt(int frame, int view) const {
    return const_cast<RigEstimate*>(this)->CameraAt(frame, view);
  }
  [[nodiscard]] Eigen::Vector3d& Joint(int frame, int joint) {
    return joints[static_cast<std::size_t>(frame - first_frame) * static_cast<std::size_t>(joint_count) +
                  static_cast<std::size_t>(joint)];
  }
  [[nodiscard]] const Eigen::Vector3d& Joint(int frame, int joint) const {
    return const_cast<RigEstimate*>(this)->Joint(frame, joint);
  }
  /// The translation of a camera, static or moving.
  [[nodiscard]] Eigen::Vector3d Translation(int frame, int view) const {
    const CameraEstimate& camera = CameraAt(frame, view);
    if (static_cameras) return Eigen::Vector3d::Map(camera.placement.data());
    return Eigen::Vector3d(camera.placement[0], camera.placement[1], camera.Focal()) / std::exp(camera.placement[2]);
  }
  /// The views whose cameras are valid in a frame, ascending.
  [[nodiscard]] std::vector<int> ValidViews(int frame) const;
  /// A point of the world in the frame of a camera.
  [[nodiscard]] Eigen::Vector3d InCamera(int frame, int view, const Eigen::Vector3d& point) const {
    return CameraAt(frame, view).Rotation() * point + Translation(frame, view);
  }
  /// A joint in the frame of a camera.
  [[nodiscard]] Eigen::Vector3d InCamera(int frame, int view, int joint) const {
    return InCamera(frame, view, Joint(frame, joint));
  }
  /// Normalised image coordinates of a joint; NaN behind the camera.
  [[nodiscard]] Eigen::Vector2d Project(int frame, int view, int joint) const {
    const Eigen::Vector3d p = InCamera(frame, view, joint);
    if (!(p.z() > 0.0)) return Eigen::Vector2d::Constant(std::nan(""));
    return CameraAt(frame, view).Focal() * p.head<2>() / p.z();
  }
  /// The length of a body unit in a view, in normalised image coordinates, at the depth of the root or, where the root
  /// is not solved, at the mean depth of the joints that are; NaN where there are none.
  [[nodiscard]] double ImageScale(int frame, int view, int root) const;

  /// A copy of frames `first` .. `first + count - 1`, which keep their numbers (`first_frame`).
  [[nodiscard]] RigEstimate Slice(int first, int count) const;
  /// Copies the joints of these frames from a slice, and the cameras where they move.
  void Adopt(const RigEstimate& slice, int first, int count);
};

}  // namespace canonpose
