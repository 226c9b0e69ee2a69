// Simulates the errors of a keypoint detector, which are far from white noise.
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

/// One strength for every kind of error. 1 stands for a modern detector on such footage, 0 switches the kind off.
/// Strengths multiply amplitudes, or how often a kind of error happens. The constants are in detector_tuning.h.
struct DetectorOptions {
  double noise = 1.0;      ///< multiplies all strengths below except `joint_offset` and `sync_jitter`; 0: exact
  double jitter = 1.0;     ///< noise of every joint, proportional to the person's size in the image
  double occlusion = 1.0;  ///< additional, temporally correlated error of joints hidden by the body itself
  double swaps = 1.0;      ///< left and right swapped for a number of frames, mostly in back views
  double outliers = 1.0;   ///< a joint found on a wrong limb or in the background
  double missed_joints = 1.0;
  double missed_frames = 1.0;
  /// How poorly confidences reflect large errors; 0: they decrease monotonically with the error.
  double confidence = 1.0;
  /// Systematic offset of the detector's joints from the skeleton's: at strength 1, a few % of the stature at the hips
  /// and shoulders. Off by default.
  double joint_offset = 0.0;
  /// Each camera's clock has a normally distributed error with this standard deviation in frames, constant over a clip.
  /// Off by default.
  double sync_jitter = 0.0;

  /// Throws Error(kInvalidArgument) that names the first option out of its range (0 to 10; sync_jitter 0 to 100).
  void Validate() const;
};

/// What a detector finds in one camera. T frames, K joints of the layout.
struct Detections {
  std::vector<float> keypoints;   ///< (T, K, 2) pixels; NaN where not detected
  std::vector<float> confidence;  ///< (T, K) 0..1; 0 where not detected
  /// What went wrong, per joint (T, K), for statistics: a combination of DetectionErrorKind. kOccluded is only set
  /// where hidden joints have additional errors (occlusion > 0); kMissed is also set for every joint of a missed frame.
  std::vector<std::uint8_t> errors;
};

enum DetectionErrorKind : std::uint8_t { kOccluded = 1, kSwapped = 2, kOutlier = 4, kMissed = 8, kOutsideImage = 16 };

/// The joints a detector finds, made from landmarks.
struct DetectorLayout {
  LayoutMapping from_landmarks;  ///< landmarks -> the layout's joints
};
/// `layout` is any skeleton that can be made from the landmarks. Throws Error(kBadInput) that names the joints that
/// cannot be made.
DetectorLayout MakeDetectorLayout(const Skeleton& layout);

/// Positions of the layout's joints, (T, K) mm in the world.
std::vector<Eigen::Vector3d> JointPositions(const LandmarkTrack& track, const DetectorLayout& layout);

/// The height in pixels of a person who stands where the pelvis of the landmarks (kLandmarkCount) is and has their
/// stature: stature times focal length over depth.
double ImageHeightPx(const Camera& camera, const Eigen::Vector3d* landmarks);

/// Runs the detector on what `camera` sees of the track. Points outside the image or behind the camera are never
/// detected. With noise 0 (and joint_offset 0) keypoints are the exact projections of JointPositions() and confidences
/// are 1. The systematic offset is a property of the detector: it is the same for all cameras and clips with the same
/// `detector_seed`.
Detections Detect(const LandmarkTrack& track, const FilmingCamera& camera, const DetectorLayout& layout,
                  const DetectorOptions& options, std::uint64_t detector_seed, Rng rng);

}  // namespace canonpose
