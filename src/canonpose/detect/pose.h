// A person's pose in an image, as the detector finds it.
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

namespace canonpose {

inline constexpr std::size_t kPoseJoints = 17;

/// The detector's joints, in the order of the layout coco-17.
enum PoseJoint : std::size_t {
  kNose,
  kLEye,
  kREye,
  kLEar,
  kREar,
  kLShoulder,
  kRShoulder,
  kLElbow,
  kRElbow,
  kLWrist,
  kRWrist,
  kLHip,
  kRHip,
  kLKnee,
  kRKnee,
  kLAnkle,
  kRAnkle,
};

struct PosePoint {
  Eigen::Vector2f position{0.0F, 0.0F};  ///< x, y; pixels of the image unless said otherwise
  float score = 0.0F;                    ///< 0..1
};

struct DetectedPose {
  std::array<PosePoint, kPoseJoints> joints;
  float score = 0.0F;  ///< of the person as a whole, 0..1
};

/// A joint with a score above this is where the network says, rather than a guess from the rest of the body.
inline constexpr float kSeenScore = 0.2F;

inline bool IsSeen(const PosePoint& point) { return point.score > kSeenScore; }

/// Mean of the joints that are seen; the zero vector where there is none.
Eigen::Vector2f CentreOf(const DetectedPose& pose);

/// A length that changes little as a person moves and turns, in pixels: the largest extent of the trunk, or of what is
/// seen of the person. At least 1.
float SizeOf(const DetectedPose& pose);

/// How many joints are seen.
int SeenCount(const DetectedPose& pose);

/// Mean distance between the joints that both poses show, in sizes of the first; infinity where there are fewer than
/// three.
float PoseDistance(const DetectedPose& a, const DetectedPose& b);

}  // namespace canonpose
