#include "canonpose/solve/write_solution.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "canonpose/solve/uncertainty.h"

namespace canonpose {
namespace {

/// How far in time the joint's neighbours carry one that no view sees.
constexpr double kCarriedSeconds = 0.1;

Camera CameraOf(const CaptureObservations& capture, const RigEstimate& estimate, int frame, int view) {
  const ObservedCamera& observed = capture.cameras[static_cast<std::size_t>(view)];
  const CameraEstimate& found = estimate.CameraAt(frame, view);
  Camera camera;
  const double focal_px = found.Focal() * observed.diagonal_px;
  const Eigen::Vector2d centre_px = 0.5 * Eigen::Vector2d(observed.image_size_px[0], observed.image_size_px[1]);
  camera.K << focal_px, 0, centre_px.x(), 0, focal_px, centre_px.y(), 0, 0, 1;
  camera.distortion = observed.lens.OpenCv(found.Focal());
  camera.camera_from_world_rotation = found.Rotation();
  camera.camera_from_world_translation = estimate.Translation(frame, view);
  return camera;
}

/// The frame of a clip nearest to `frame` in which the view's camera is known; -1 where there is none.
int NearestKnownFrame(const RigEstimate& estimate, const ClipRange& clip, int frame, int view) {
  for (int distance = 0; distance < clip.count; ++distance) {
    for (const int n : {frame - distance, frame + distance}) {
      if (n >= clip.first && n < clip.first + clip.count && estimate.CameraAt(n, view).valid) return n;
    }
  }
  return -1;
}

/// The time of a view as it was recorded.
struct OwnTime {
  TimeMap clock;  ///< to the frames that `correction` begins with
  const ViewCorrection& correction;

  /// The time of the view's frame t in frames of the clip; NaN where it is left out.
  [[nodiscard]] double At(int t) const { return correction.TimeOf(clock.At(t)); }
  [[nodiscard]] double rate() const { return correction.reading.time.rate * clock.rate; }
};

/// The cameras of a view's own frames.
void WriteCameras(const CaptureObservations& capture, const RigEstimate& estimate, const ClipRange& clip, int v,
                  const OwnTime& own, CameraView& view) {
  if (capture.static_cameras) {
    if (estimate.CameraAt(0, v).valid) view.solved_calibration = {CameraOf(capture, estimate, 0, v)};
    return;
  }
  if (NearestKnownFrame(estimate, clip, clip.first, v) < 0) return;
  for (int t = 0; t < clip.count; ++t) {
    const double time = own.At(t);
    const int n = std::isfinite(time) ? std::clamp(static_cast<int>(std::lround(time)), 0, clip.count - 1) : t;
    const int known = NearestKnownFrame(estimate, clip, clip.first + n, v);
    view.solved_calibration.push_back(CameraOf(capture, estimate, known, v));
  }
}

/// CameraView::solved_frames.
std::vector<double> FramesShown(const OwnTime& own, const ClipRange& clip) {
  const auto is_jump = [](const BadStretch& bad) { return bad.fault == StretchFault::kTimeJump; };
  if (own.rate() == 1.0 && std::ranges::none_of(own.correction.bad, is_jump)) return {};
  std::vector<double> frames;
  for (int t = 0; t < clip.count; ++t) frames.push_back(own.At(t));
  return frames;
}

/// CameraView::time_offset_seconds.
double OffsetSeconds(const OwnTime& own, const ClipRange& clip) {
  const ViewCorrection& correction = own.correction;
  const double after_clock =
      correction.offset_frames + (correction.reading.time.rate == 1.0 ? correction.reading.time.offset : 0.0);
  return (own.clock.offset + after_clock) / clip.fps;
}

/// Keypoints as the correction reads them.
void CorrectKeypoints(const Skeleton& skeleton, const ViewReading& reading, CameraView& view) {
  if (!reading.is_mirrored && !reading.sides_are_exchanged) return;
  const auto joints = static_cast<std::size_t>(skeleton.joint_count());
  const CameraView recorded = view;
  for (std::size_t i = 0; i < view.confidence.size(); ++i) {
    const std::size_t j = i % joints;
    const std::size_t from = reading.sides_are_exchanged ? i - j + static_cast<std::size_t>(skeleton.mirror[j]) : i;
    const float x = recorded.keypoints[2 * from];
    view.keypoints[2 * i] = reading.is_mirrored ? static_cast<float>(view.image_size[0]) - x : x;
    view.keypoints[2 * i + 1] = recorded.keypoints[2 * from + 1];
    view.confidence[i] = recorded.confidence[from];
  }
}

/// What is written of the joints of a capture (F, J).
struct JointStates {
  std::vector<bool> written;  ///< the joint is seen, or its neighbours in time carry it
  std::vector<bool> seen;     ///< by a view that has a camera
  std::vector<double> uncertainty;
};

JointStates StatesOf(const CaptureObservations& capture, const Solution& solution) {
  const auto joints = static_cast<std::size_t>(capture.joint_count());
  JointStates states;
  for (int n = 0; n < capture.frame_count; ++n) {
    for (int j = 0; j < capture.joint_count(); ++j) {
      bool seen = false;
      for (int v = 0; v < capture.view_count(); ++v) {
        seen = seen || (capture.Sees(n, v, j) && solution.estimate.CameraAt(n, v).valid);
      }
      states.seen.push_back(seen);
    }
  }
  states.uncertainty = MeasureUncertainty(capture, solution);
  states.written = states.seen;
  for (const ClipRange& clip : capture.clips) {
    const int reach = static_cast<int>(kCarriedSeconds * clip.fps);
    for (int t = 0; t < clip.count; ++t) {
      for (std::size_t j = 0; j < joints; ++j) {
        const auto is_seen = [&](int from, int to) {
          for (int other = std::max(0, from); other <= std::min(clip.count - 1, to); ++other) {
            if (states.seen[static_cast<std::size_t>(clip.first + other) * joints + j]) return true;
          }
          return false;
        };
        const std::size_t i = static_cast<std::size_t>(clip.first + t) * joints + j;
        states.written[i] = states.seen[i] || (is_seen(t - reach, t - 1) && is_seen(t + 1, t + reach));
      }
    }
  }
  return states;
}

/// The poses of a view in which no joint was solved.
PoseSequence NothingSolved(const Skeleton& skeleton, const ClipRange& clip, const CameraView& view) {
  PoseSequence solved(skeleton, clip.count);
  solved.unit = LengthUnit::kBodyLengths;
  solved.coordinate_frame = {CoordinateFrame::Kind::kCamera, view.name};
  return solved;
}

class ViewWriter {
 public:
  ViewWriter(const CaptureObservations& capture, const Solution& solution, const JointStates& states,
             const ClipRange& clip, int view)
      : capture_(capture), estimate_(solution.estimate), states_(states), clip_(clip), view_(view) {}

  /// Poses in the view's own frames.
  [[nodiscard]] PoseSequence Poses(const OwnTime& own, const Skeleton& skeleton, const CameraView& view) const;

 private:
  /// A joint in the camera's frame at a time in frames of the clip, between frames by linear interpolation; NaN where
  /// it is not solved.
  [[nodiscard]] Eigen::Vector3d InCameraAt(double time, int joint) const;
  [[nodiscard]] std::size_t Index(int t, int joint) const {
    return static_cast<std::size_t>(clip_.first + t) * static_cast<std::size_t>(capture_.joint_count()) +
           static_cast<std::size_t>(joint);
  }

  const CaptureObservations& capture_;
  const RigEstimate& estimate_;
  const JointStates& states_;
  const ClipRange& clip_;
  int view_;
};

Eigen::Vector3d ViewWriter::InCameraAt(double time, int joint) const {
  const auto before = static_cast<int>(std::floor(time));
  const double share = time - before;
  const auto at = [&](int t) -> Eigen::Vector3d {
    const bool is_known = t >= 0 && t < clip_.count && estimate_.CameraAt(clip_.first + t, view_).valid &&
                          states_.written[Index(t, joint)];
    if (!is_known) return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    return estimate_.InCamera(clip_.first + t, view_, joint);
  };
  if (share < 1e-9) return at(before);
  return (1.0 - share) * at(before) + share * at(before + 1);
}

PoseSequence ViewWriter::Poses(const OwnTime& own, const Skeleton& skeleton, const CameraView& view) const {
  PoseSequence solved = NothingSolved(skeleton, clip_, view);
  for (int t = 0; t < clip_.count; ++t) {
    const double time = own.At(t);
    if (!(time >= 0.0 && time <= clip_.count - 1.0)) continue;
    for (int j = 0; j < capture_.joint_count(); ++j) {
      const Eigen::Vector3d position = InCameraAt(time, j);
      if (!position.cast<float>().allFinite()) continue;
      const int joint = capture_.dataset_joints[static_cast<std::size_t>(j)];
      const std::size_t nearest = Index(static_cast<int>(std::lround(time)), j);
      const std::size_t i = static_cast<std::size_t>(t) * static_cast<std::size_t>(skeleton.joint_count()) +
                            static_cast<std::size_t>(joint);
      solved.PoseAt(t).row(joint) = position.cast<float>().transpose();
      solved.standard_deviation()[i] = static_cast<float>(states_.uncertainty[nearest]);
      solved.confidence()[i] = states_.seen[nearest] ? 1.0F : 0.0F;
    }
  }
  return solved;
}

}  // namespace

void WriteSolution(const CaptureObservations& capture, const Solution& solution, const CameraCheck& check,
                   const std::vector<std::vector<TimeMap>>& clocks, Dataset& dataset) {
  const JointStates states = StatesOf(capture, solution);
  for (std::size_t c = 0; c < capture.clips.size(); ++c) {
    const ClipRange& clip = capture.clips[c];
    for (CameraView& view : dataset.sequences[clip.sequence].cameras) {
      const int v = capture.FindView(view.name);
      const ViewCorrection& correction = check.At(static_cast<int>(c), v);
      const OwnTime own{clocks[c][static_cast<std::size_t>(v)], correction};
      view.image_size = capture.cameras[static_cast<std::size_t>(v)].image_size_px;
      CorrectKeypoints(dataset.skeleton, correction.reading, view);
      view.solved = ViewWriter(capture, solution, states, clip, v).Poses(own, dataset.skeleton, view);
      view.time_offset_seconds = OffsetSeconds(own, clip);
      view.solved_frames = FramesShown(own, clip);
      WriteCameras(capture, solution.estimate, clip, v, own, view);
    }
  }
}

void WriteNothing(const CaptureObservations& capture, Dataset& dataset) {
  for (const ClipRange& clip : capture.clips) {
    for (CameraView& view : dataset.sequences[clip.sequence].cameras) {
      view.solved = NothingSolved(dataset.skeleton, clip, view);
    }
  }
}

}  // namespace canonpose
