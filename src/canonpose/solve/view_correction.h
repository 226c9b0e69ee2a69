// What has to be corrected in a view so that it fits the others: keypoints that belong to other times, to a mirrored
// image or to an image of another size, and frames that have to be left out.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "canonpose/solve/observations.h"

namespace canonpose {

/// From the frames of a view to those of the other views, counted from the beginning of the clip.
struct TimeMap {
  double rate = 1.0;  ///< -1: the view runs backwards
  double offset = 0.0;

  [[nodiscard]] double At(double frame) const { return rate * frame + offset; }
  [[nodiscard]] bool IsIdentity() const { return rate == 1.0 && offset == 0.0; }
};

struct ViewReading {
  TimeMap time;
  bool is_mirrored = false;          ///< the image shows left where right is
  bool sides_are_exchanged = false;  ///< names of left and right joints are exchanged, as a detector does in a mirror

  [[nodiscard]] bool IsIdentity() const { return time.IsIdentity() && !is_mirrored && !sides_are_exchanged; }
  /// A keypoint in the normalised coordinates of this reading.
  [[nodiscard]] Eigen::Vector2d Read(const Eigen::Vector2d& keypoint) const {
    return {is_mirrored ? -keypoint.x() : keypoint.x(), keypoint.y()};
  }
};

/// Why frames of a view do not fit.
enum class StretchFault {
  kCameraMoved,  ///< another placement of the camera fits them
  kTimeJump,     ///< the same camera fits them at another time: frames were lost before
  kOther,        ///< nothing does: another person, another take, wrong keypoints
};

/// Frames of a clip, in the view's own time, in which it does not fit the others.
struct BadStretch {
  int first = 0;
  int count = 0;
  StretchFault fault = StretchFault::kOther;
  int jump_frames = 0;  ///< kTimeJump: the others show in t + jump_frames what the view shows in its frame t
};

/// What has to be corrected in a view in one clip.
struct ViewCorrection {
  ViewReading reading;
  int offset_frames = 0;  ///< added to the reading's time
  std::vector<BadStretch> bad;

  [[nodiscard]] bool IsNone() const { return reading.IsIdentity() && offset_frames == 0 && bad.empty(); }
  /// The time of the view's frame t, or of a time between frames, in frames of the clip; NaN where it is left out.
  [[nodiscard]] double TimeOf(double t) const;
};

/// Corrects what a view saw in a clip: keypoints, confidences and start poses move to the frames of the other views,
/// the nearest where times fall between frames, and what is left out is removed.
void ApplyCorrection(const ViewCorrection& correction, int clip, int view, CaptureObservations& capture);

/// Removes what a view saw in frames `first` .. `first + count - 1` of the capture.
void DropFrames(int view, int first, int count, CaptureObservations& capture);

/// Replaces what a view saw in `to` by what it saw in `from`, a capture of the same frames and cameras.
void CopyView(const CaptureObservations& from, int view, CaptureObservations& to);

/// What a reading says of the camera, in words that follow its name: "is mirrored". Empty for the identity.
std::string Describe(const ViewReading& reading, double fps);

}  // namespace canonpose
