// What the solver sees of a capture: the 2D joints of all its frames and cameras, in normalised image coordinates.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "canonpose/data/dataset.h"
#include "canonpose/geometry/points.h"
#include "canonpose/solve/lens.h"

namespace canonpose {

/// The start: rough poses of every view, from which the solver starts. A lifter found them in each view by itself, or a
/// factorisation found them. Indexed like Dataset::sequences and their cameras; relative to the root, with the axes of
/// the camera, in any unit; missing in frames where the start has no pose, empty where it has none of a whole view.
struct StartPoses {
  std::vector<std::vector<PoseSequence>> sequences;
  /// Whether they say which way round depth is. A factorisation's may as well be the mirror image.
  bool knows_depth_sign = true;
};

/// Consecutive frames of one sequence.
struct ClipRange {
  std::size_t sequence = 0;  ///< index into Dataset::sequences
  int first = 0;             ///< its first frame among those of the capture
  int count = 0;
  double fps = 0.0;  ///< never 0: 30 where the dataset does not say
  int subject = 0;   ///< index into `subjects`; clips of one subject share their bone lengths
  FrameTiming timing = FrameTiming::kCommon;
  bool fps_is_known = true;  ///< otherwise the views may even have different ones
};

struct ObservedCamera {
  std::string name;
  std::array<int, 2> image_size_px{0, 0};
  std::array<int, 2> declared_size_px{0, 0};  ///< in the dataset; another where that was found to be wrong
  /// Normalised image coordinates are (pixel - image centre) / diagonal_px; focal lengths, too, are in image diagonals.
  double diagonal_px = 0.0;
  RadialLens lens{};  ///< that CaptureObservations::xy have been undistorted with
};

/// F frames of V cameras that belong together: all clips of the same static cameras, or one clip of moving ones.
struct CaptureObservations {
  std::string name;
  Skeleton skeleton;                       ///< of the joints that some view sees in some frame, and the root
  std::vector<int> dataset_joints;         ///< (J) where they are in the dataset's skeleton
  std::vector<std::string> unseen_joints;  ///< of the dataset's skeleton, those that are left out
  bool static_cameras = true;
  std::vector<ObservedCamera> cameras;
  std::vector<ClipRange> clips;
  std::vector<std::string> subjects;
  int frame_count = 0;
  std::vector<float> xy;          ///< (F, V, J, 2) normalised, undistorted; NaN where not detected
  std::vector<float> confidence;  ///< (F, V, J) 0 where not detected
  /// (F, V, J, 3) StartPoses of unit norm; NaN where there is none, at the root for joints that the start does not
  /// know.
  std::vector<float> start;

  [[nodiscard]] int view_count() const { return static_cast<int>(cameras.size()); }
  /// The view of a camera; -1 where there is none of that name.
  [[nodiscard]] int FindView(std::string_view camera) const;
  [[nodiscard]] int joint_count() const { return skeleton.joint_count(); }
  [[nodiscard]] std::size_t Index(int frame, int view, int joint) const {
    return (static_cast<std::size_t>(frame) * cameras.size() + static_cast<std::size_t>(view)) *
               skeleton.joints.size() +
           static_cast<std::size_t>(joint);
  }
  [[nodiscard]] bool Sees(int frame, int view, int joint) const { return confidence[Index(frame, view, joint)] > 0.0F; }
  [[nodiscard]] Eigen::Vector2d At(int frame, int view, int joint) const {
    const std::size_t i = 2 * Index(frame, view, joint);
    return {xy[i], xy[i + 1]};
  }
  /// Whether the view shows the root and has a start pose.
  [[nodiscard]] bool HasStart(int frame, int view) const;
  /// (J, 3), NaN where there is none.
  [[nodiscard]] Points3d StartOf(int frame, int view) const;
  [[nodiscard]] const ClipRange& ClipOf(int frame) const;
};

/// The captures of a dataset. Cameras of a static capture are matched by name over its sequences. Throws
/// Error(kBadInput) where a camera changes its image size within a capture.
std::vector<CaptureObservations> CollectCaptures(const Dataset& dataset, const StartPoses& start);

/// One clip of a capture, as a capture of its own.
CaptureObservations SingleClip(const CaptureObservations& capture, int clip);

/// A capture of one frame that shows the keypoints which view v has in frame `frame_of_view[v]` (V); none where that is
/// negative. It has no clips and no start poses.
CaptureObservations SingleFrame(const CaptureObservations& capture, std::span<const int> frame_of_view);

/// Undistorts the keypoints of a view with another lens than before.
void SetLens(CaptureObservations& capture, int view, const RadialLens& lens);

/// Whether two captures of the same frames and cameras have the same keypoints, those that are not seen included.
bool HasSameKeypoints(const CaptureObservations& a, const CaptureObservations& b);

}  // namespace canonpose
