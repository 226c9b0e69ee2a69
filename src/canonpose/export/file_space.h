// Axes and unit of a file: the one place where a scene's coordinates become those that another program expects.
#pragma once

#include <string>

#include <Eigen/Core>

#include "canonpose/scene/scene.h"

namespace canonpose {

/// The axis of a file that points up. Both are right-handed and share x: (x, y, z) with z up is (x, z, -y) with y up.
enum class UpAxis { kY, kZ };
enum class FileUnit { kMillimetres, kMetres };

/// "y", "z"; "mm", "m".
std::string ToString(UpAxis up);
std::string ToString(FileUnit unit);

/// Converts positions, lengths and cameras of a scene. Where the scene does not know which way is up, its axes stay as
/// they are, and where it does not know its size, so do its lengths: nothing is made up, and up() and unit() say so.
class FileSpace {
 public:
  FileSpace(const Scene& scene, UpAxis up, FileUnit unit);

  /// Of a joint; NaN where it is unknown.
  [[nodiscard]] Eigen::Vector3d Position(const PoseSequence& person, int frame, int joint) const;
  /// Of a length in the scene's unit.
  [[nodiscard]] double Length(double length) const { return scale_ * length; }
  /// The camera that sees the file's points where `camera` sees the scene's.
  [[nodiscard]] Camera InFile(const Camera& camera) const;

  [[nodiscard]] bool up_is_known() const { return up_ != "unknown"; }
  [[nodiscard]] bool unit_is_known() const { return unit_is_known_; }
  /// "y", "z" or "unknown".
  [[nodiscard]] const std::string& up() const { return up_; }
  /// "mm", "m", "body lengths" or "each pose its own".
  [[nodiscard]] const std::string& unit() const { return unit_; }
  /// What is unknown, in a clause for comments; empty where nothing is: "unit: body lengths, up: unknown".
  [[nodiscard]] std::string Unknowns() const;
  /// As many digits after the point as make less than 0.01 mm.
  [[nodiscard]] int decimals() const { return unit_ == "mm" ? 3 : 6; }

 private:
  Eigen::Matrix3d file_from_scene_rotation_ = Eigen::Matrix3d::Identity();
  double scale_ = 1.0;
  bool unit_is_known_ = false;
  std::string up_ = "unknown";
  std::string unit_;
};

}  // namespace canonpose
