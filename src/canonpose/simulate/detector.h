// A keypoint detector's errors, as a detector makes them: not white noise.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "canonpose/base/random.h"
#include "canonpose/motion/landmarks.h"
#include "canonpose/simulate/rig.h"
#include "canonpose/skeleton/mapping.h"

namespace canonpose {

/// One parameter for every kind of error. 1 is a modern detector on such footage; 0 leaves the kind out. Strengths
/// multiply amplitudes, or how often a kind happens. Constants are in detector_tuning.h.
struct DetectorOptions {
  double noise = 1.0;      ///< multiplies all the others below except `joint_offset` and `sync_jitter`; 0: exact
  double jitter = 1.0;     ///< noise of every joint, in proportion to the person's size in the image
  double occlusion = 1.0;  ///< extra error, correlated over time, of joints hidden by the body itself
  double swaps = 1.0;      ///< left and right exchanged, mostly in back views, for a stretch of frames
  double outliers = 1.0;   ///< a joint found on a wrong limb or in the background
  double missed_joints = 1.0;
  double missed_frames = 1.0;
  double confidence = 1.0;  ///< how badly confidences tell large errors; 0: they fall steadily with the error
  /// Systematic offset of the detector's joints from the skeleton's, a few % of the stature at the hips and shoulders;
  /// off by default.
  double joint_offset = 0.0;
  /// Each camera's clock is off by a normal error of this many frames, the same over a clip; off by default.
  double sync_jitter = 0.0;

  /// Throws Error(kInvalidArgument) naming the first option that is out of range (0 to 10; sync_jitter 0 to 100).
  void Validate() const;
};

/// What a detector finds in one camera. T frames, K joints of the layout.
struct Detections {
  std::vector<float> keypoints;   ///< (T, K, 2) pixels; NaN where not detected
  std::vector<float> confidence;  ///< (T, K) 0..1; 0 where not detected
  /// What went wrong, per joint (T, K), for statistics: a combination of DetectionErrorKind. kOccluded is told where
  /// hidden joints have errors of their own (occlusion > 0), kMissed also of every joint of a missed frame.
  std::vector<std::uint8_t> errors;
};

enum DetectionErrorKind : std::uint8_t { kOccluded = 1, kSwapped = 2, kOutlier = 4, kMissed = 8, kOutsideImage = 16 };

/// The joints a detector finds, made from landmarks.
struct DetectorLayout {
  LayoutMapping from_landmarks;  ///< landmarks -> the layout's joints
};
/// `layout` is any skeleton that can be made from the landmarks. Throws Error(kBadInput) naming the joints that cannot.
DetectorLayout MakeDetectorLayout(const Skeleton& layout);

/// Positions of the layout's joints, (T, K) mm in the world.
std::vector<Eigen::Vector3d> JointPositions(const LandmarkTrack& track, const DetectorLayout& layout);

/// Height of a standing person of the landmarks' (kLandmarkCount) stature where its pelvis is: stature times focal
/// length over depth, pixels.
double ImageHeightPx(const Camera& camera, const Eigen::Vector3d* landmarks);

/// Runs the detector over what `camera` sees of the track. Points outside the image or behind the camera are not
/// detected, whatever the options. With noise 0 (and joint_offset 0) keypoints are the exact projections of
/// JointPositions() and confidences are 1. The systematic offset belongs to the detector: the same for all cameras and
/// clips of a `detector_seed`.
Detections Detect(const LandmarkTrack& track, const FilmingCamera& camera, const DetectorLayout& layout,
                  const DetectorOptions& options, std::uint64_t detector_seed, Rng rng);

}  // namespace canonpose
