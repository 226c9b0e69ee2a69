// All constants of the simulated detector's errors. Internal to simulate/.
//
// Lengths are fractions of the person's height in the image, times are in seconds, rates are per second. They were
// chosen to reach these statistics: median error 1 to 1.5 % of the height, wrists and ankles 1.5 to 2 times the hips,
// 95th percentile 5 to 8 %, AUC of confidence 0.7 to 0.8, rank correlation of confidence and error -0.3 to -0.5, swaps
// and outliers about 1 % of joints each, missed joints 1 to 2 %.
#pragma once

#include <array>

#include "canonpose/motion/landmarks.h"

namespace canonpose::tuning {

/// How well a class of joints is found.
struct JointClass {
  double slow;      ///< standard deviation of the slow error, which is where the network believes the joint to be
  double fast;      ///< and of the fast error, from frame to frame
  double occluded;  ///< and of the error while hidden
  double outlier;   ///< how often an outlier begins, relative to a knee
  double missed;    ///< how often it is not found, relative to a knee
};

// Hips and trunk are points inside the body, which annotators place imprecisely but consistently: slow errors, little
// jitter. Faces are precise. Wrists, ankles and toes are small, at the ends of limbs, and fast.
inline constexpr JointClass kTrunk = {0.0070, 0.0015, 0.012, 0.3, 0.3};
inline constexpr JointClass kHips = {0.0082, 0.0016, 0.016, 0.4, 0.4};
inline constexpr JointClass kShoulders = {0.0070, 0.0024, 0.018, 0.4, 0.5};
inline constexpr JointClass kHeadJoints = {0.0056, 0.0020, 0.015, 0.3, 0.5};
inline constexpr JointClass kKnees = {0.0082, 0.0030, 0.025, 1.0, 1.0};
inline constexpr JointClass kElbows = {0.0088, 0.0034, 0.030, 1.3, 1.4};
inline constexpr JointClass kAnkles = {0.0110, 0.0042, 0.030, 1.5, 1.4};
inline constexpr JointClass kWrists = {0.0112, 0.0048, 0.036, 2.0, 2.0};
inline constexpr JointClass kToes = {0.0124, 0.0060, 0.034, 1.5, 2.0};

inline constexpr double kSlowSeconds = 0.5;
inline constexpr double kFastSeconds = 0.02;
/// The scale of errors varies over time as exp(normal), for each joint and for the whole person: difficult poses and
/// frames give heavy tails.
inline constexpr double kScaleOfJoint = 0.50;
inline constexpr double kScaleOfPerson = 0.20;
inline constexpr double kScaleSeconds = 0.4;
/// Motion blur: how much the scale grows per unit of a joint's speed in the image, statures per second.
inline constexpr double kBlur = 0.25;
inline constexpr double kMaxBlurSpeed = 6.0;

/// Hidden joints: additional errors, and a pull towards the joint on the other side.
inline constexpr double kOccludedSeconds = 0.35;
inline constexpr double kOcclusionRampSeconds = 0.08;
inline constexpr double kPull = 0.12;        ///< mean fraction of the distance to the joint on the other side
inline constexpr double kPullSpread = 0.12;  ///< and its standard deviation
inline constexpr double kMaxPull = 0.05;     ///< maximum distance

/// An interval in which something goes wrong: how often it starts and how long it lasts.
struct Stretch {
  double rate;
  double shortest_seconds;
  double longest_seconds;
};
inline constexpr Stretch kLegSwap = {0.11, 0.1, 0.5};
inline constexpr Stretch kBodySwap = {0.065, 0.1, 0.5};
inline constexpr Stretch kOutlier = {0.07, 0.03, 0.20};
inline constexpr Stretch kMissedJoint = {0.075, 0.03, 0.20};
inline constexpr Stretch kMissedFrame = {0.035, 0.03, 0.30};
/// Swaps start at the full rate in back views, and at these fractions of it in side and front views.
inline constexpr double kSwapSideView = 0.35;
inline constexpr double kSwapFrontView = 0.05;
/// Outliers and misses of hidden joints, relative to visible ones.
inline constexpr double kOutlierWhenOccluded = 3.0;
inline constexpr double kMissedWhenOccluded = 7.0;
/// No event starts more often than this, whatever the option's strength.
inline constexpr double kMaxRate = 20.0;
/// Where outliers go: to the joint on the other side, to some other joint, or to the background.
inline constexpr double kOutlierToMirror = 0.45;
inline constexpr double kOutlierToJoint = 0.25;
inline constexpr double kBackgroundNear = 0.15;
inline constexpr double kBackgroundFar = 0.60;

/// Confidence = logistic(kConfidenceAtTypical - kConfidenceSlope * log((error + floor) / typical) + noise).
inline constexpr double kConfidenceAtTypical = 1.45;
inline constexpr double kConfidenceSlope = 0.62;
inline constexpr double kConfidenceTypical = 0.013;
inline constexpr double kConfidenceFloor = 0.002;
inline constexpr double kConfidenceNoiseSlow = 0.70;
inline constexpr double kConfidenceNoiseFast = 0.50;
inline constexpr double kConfidenceSeconds = 0.5;

/// Systematic offsets for joint_offset 1, as fractions of the stature: the mean upwards and outwards, and how much
/// detectors differ. For hips, the mean is the difference between COCO's annotations and Human3.6M's markers.
struct SystematicOffset {
  double up;
  double outwards;
  double spread;  ///< standard deviation by axis
};
inline constexpr SystematicOffset kHipOffset = {0.030, 0.010, 0.008};
inline constexpr SystematicOffset kShoulderOffset = {-0.020, -0.012, 0.010};
inline constexpr SystematicOffset kTrunkOffset = {0.000, 0.000, 0.010};
inline constexpr SystematicOffset kHeadOffset = {-0.015, 0.000, 0.008};
inline constexpr SystematicOffset kLimbOffset = {0.000, 0.000, 0.008};

/// The class of a landmark.
constexpr const JointClass& ClassOf(int landmark) {
  switch (landmark) {
    case kRHip:
    case kLHip:
    case kHip:
      return kHips;
    case kLShoulder:
    case kRShoulder:
      return kShoulders;
    case kNose:
    case kHead:
    case kREye:
    case kLEye:
    case kREar:
    case kLEar:
      return kHeadJoints;
    case kRKnee:
    case kLKnee:
      return kKnees;
    case kRElbow:
    case kLElbow:
      return kElbows;
    case kRFoot:
    case kLFoot:
      return kAnkles;
    case kRWrist:
    case kLWrist:
      return kWrists;
    case kLBigToe:
    case kLSmallToe:
    case kLHeel:
    case kRBigToe:
    case kRSmallToe:
    case kRHeel:
      return kToes;
    default:
      return kTrunk;
  }
}

}  // namespace canonpose::tuning
