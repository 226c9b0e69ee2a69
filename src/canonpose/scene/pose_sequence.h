// The 3D poses of one person over time: the form in which every part of the program hands them on.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "canonpose/skeleton/skeleton.h"

namespace canonpose {

/// What a coordinate of 1 means.
enum class LengthUnit {
  kMillimetres,
  kBodyLengths,  ///< one unknown scale for the whole sequence, and for the cameras of its scene
  kEachItsOwn,   ///< each pose has an unknown scale of its own, as a single view gives it
};

/// "mm", "body lengths" or "each pose its own".
std::string ToString(LengthUnit unit);

/// Axes and origin that positions refer to.
struct CoordinateFrame {
  enum class Kind {
    kWorld,   ///< of the scene (scene.h)
    kCamera,  ///< x right, y down, z forward; the origin is the camera's centre
    kRoot,    ///< axes of the camera; the origin is the root joint of each pose
    kBody,    ///< axes that move with the body, as a lifter defines them; the origin is the root joint of each pose
  };
  Kind kind = Kind::kWorld;
  std::string camera;  ///< whose, for kCamera and kRoot

  bool operator==(const CoordinateFrame&) const = default;
};

/// T poses of J joints. Missing joints are NaN with confidence 0.
class PoseSequence {
 public:
  /// Rows are joints, columns x, y, z.
  using Pose = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;

  PoseSequence() = default;
  /// All joints missing.
  PoseSequence(Skeleton skeleton, int frame_count);
  /// Takes over positions (T, J, 3); each known joint has confidence 1. Throws std::logic_error where their number is
  /// not a multiple of J poses.
  PoseSequence(Skeleton skeleton, std::vector<float> positions);

  [[nodiscard]] const Skeleton& skeleton() const { return skeleton_; }
  [[nodiscard]] int frame_count() const { return frame_count_; }
  [[nodiscard]] int joint_count() const { return skeleton_.joint_count(); }
  [[nodiscard]] bool empty() const { return frame_count_ == 0; }

  [[nodiscard]] Eigen::Map<Pose> PoseAt(int frame) { return {positions_.data() + Offset(frame), joint_count(), 3}; }
  [[nodiscard]] Eigen::Map<const Pose> PoseAt(int frame) const {
    return {positions_.data() + Offset(frame), joint_count(), 3};
  }
  [[nodiscard]] bool IsKnown(int frame, int joint) const { return PoseAt(frame).row(joint).allFinite(); }
  [[nodiscard]] bool AnyKnown() const;

  /// Sets the confidence of every joint: 1 where it is known, otherwise 0.
  void TrustKnownJoints();
  /// Keeps the frames first, first + step, ... up to last, which may lie beyond the end.
  void KeepFrames(int first, int last, int step = 1);

  /// (T, J, 3), (T, J) 0..1, and (T, J) along an axis in `unit`, NaN where unknown; row-major.
  [[nodiscard]] std::vector<float>& positions() { return positions_; }
  [[nodiscard]] const std::vector<float>& positions() const { return positions_; }
  [[nodiscard]] std::vector<float>& confidence() { return confidence_; }
  [[nodiscard]] const std::vector<float>& confidence() const { return confidence_; }
  [[nodiscard]] std::vector<float>& standard_deviation() { return standard_deviation_; }
  [[nodiscard]] const std::vector<float>& standard_deviation() const { return standard_deviation_; }

  std::string name;  ///< of the person
  LengthUnit unit = LengthUnit::kBodyLengths;
  CoordinateFrame coordinate_frame;
  double fps = 0.0;                  ///< 0 where unknown
  std::vector<double> time_seconds;  ///< (T); empty: frame / fps

  /// Seconds from the first frame's time stamp 0; the frame's number where neither stamps nor fps are known.
  [[nodiscard]] double TimeOf(int frame) const;

 private:
  [[nodiscard]] std::ptrdiff_t Offset(int frame) const {
    return 3 * static_cast<std::ptrdiff_t>(frame) * static_cast<std::ptrdiff_t>(joint_count());
  }

  Skeleton skeleton_;
  int frame_count_ = 0;
  std::vector<float> positions_;
  std::vector<float> confidence_;
  std::vector<float> standard_deviation_;
};

/// Poses (T, J, 3) in the frame of a camera; none where there are no positions.
PoseSequence PosesInCamera(const Skeleton& skeleton, std::vector<float> positions, LengthUnit unit,
                           const std::string& camera);

/// The same for poses that are relative to their root joints and each of a scale of its own, as a lifter gives them.
PoseSequence PosesAboutRoot(const Skeleton& skeleton, std::vector<float> positions, const std::string& camera);

}  // namespace canonpose
