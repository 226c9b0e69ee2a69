#include "canonpose/export/file_space.h"

#include <limits>

namespace canonpose {

std::string ToString(UpAxis up) { return up == UpAxis::kY ? "y" : "z"; }

std::string ToString(FileUnit unit) { return unit == FileUnit::kMillimetres ? "mm" : "m"; }

FileSpace::FileSpace(const Scene& scene, UpAxis up, FileUnit unit) {
  if (scene.up.is_known()) {
    up_ = ToString(up);
    if (up == UpAxis::kY) file_from_scene_rotation_ << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  }
  const LengthUnit own = scene.people.empty() ? LengthUnit::kMillimetres : scene.people.front().unit;
  unit_is_known_ = own == LengthUnit::kMillimetres;
  unit_ = unit_is_known_ ? ToString(unit) : ToString(own);
  if (unit_is_known_ && unit == FileUnit::kMetres) scale_ = 1e-3;
}

Eigen::Vector3d FileSpace::Position(const PoseSequence& person, int frame, int joint) const {
  if (!person.IsKnown(frame, joint)) return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  const Eigen::Vector3d in_scene = person.PoseAt(frame).row(joint).transpose().cast<double>();
  return scale_ * (file_from_scene_rotation_ * in_scene);
}

Camera FileSpace::InFile(const Camera& camera) const {
  Camera in_file = camera;
  in_file.camera_from_world_rotation = camera.camera_from_world_rotation * file_from_scene_rotation_.transpose();
  in_file.camera_from_world_translation = scale_ * camera.camera_from_world_translation;
  return in_file;
}

std::string FileSpace::Unknowns() const {
  std::string text;
  if (!unit_is_known_) text = "unit: " + unit_;
  if (!up_is_known()) text += std::string(text.empty() ? "" : ", ") + "up: unknown";
  return text;
}

}  // namespace canonpose
