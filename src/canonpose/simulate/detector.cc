#include "canonpose/simulate/detector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "canonpose/base/error.h"
#include "canonpose/simulate/detector_errors.h"
#include "canonpose/simulate/detector_tuning.h"
#include "canonpose/simulate/occlusion.h"

namespace canonpose {
namespace {

constexpr double kMaxStrength = 10.0;
constexpr double kMaxSyncFrames = 100.0;

/// Right-handed axes as columns: forward, left, up, for a given `up` and with left roughly along `across`.
Eigen::Matrix3d Axes(const Eigen::Vector3d& upwards, const Eigen::Vector3d& across) {
  const Eigen::Vector3d up = upwards.normalized();
  Eigen::Vector3d left = across - up * up.dot(across);
  // A body without width has no front, so any axis will do.
  if (!(left.norm() > 1e-6)) left = up.unitOrthogonal();
  left.normalize();
  Eigen::Matrix3d axes;
  axes << left.cross(up), left, up;
  return axes;
}

Eigen::Matrix3d TrunkAxes(const Eigen::Vector3d* p) { return Axes(p[kThorax] - p[kHip], p[kLHip] - p[kRHip]); }

/// The axes with which a joint's systematic offset rotates: those of the trunk, the head, or its limb.
Eigen::Matrix3d OffsetAxes(int landmark, const Eigen::Vector3d* p, const Eigen::Matrix3d& trunk) {
  const tuning::JointClass* its_class = &tuning::ClassOf(landmark);
  if (its_class == &tuning::kHeadJoints) return Axes(p[kHead] - p[kUpperNeck], p[kLEar] - p[kREar]);
  if (its_class == &tuning::kHips || its_class == &tuning::kShoulders || its_class == &tuning::kTrunk) return trunk;
  const int parent = LandmarkSkeleton().parents[static_cast<std::size_t>(landmark)];
  return Axes(p[parent] - p[landmark], trunk.col(1));
}

const tuning::SystematicOffset& OffsetOf(int landmark) {
  const tuning::JointClass* its_class = &tuning::ClassOf(landmark);
  if (its_class == &tuning::kHips) return tuning::kHipOffset;
  if (its_class == &tuning::kShoulders) return tuning::kShoulderOffset;
  if (its_class == &tuning::kHeadJoints) return tuning::kHeadOffset;
  if (its_class == &tuning::kTrunk) return tuning::kTrunkOffset;
  return tuning::kLimbOffset;
}

/// The offset of a detector's joints from the skeleton's: forward, left and up in OffsetAxes(), as fractions of the
/// stature. Left and right are symmetric; joints on the midline stay on it.
std::array<Eigen::Vector3d, kLandmarkCount> SystematicOffsets(double strength, std::uint64_t detector_seed) {
  std::array<Eigen::Vector3d, kLandmarkCount> offsets;
  const Skeleton& skeleton = LandmarkSkeleton();
  for (int j = 0; j < kLandmarkCount; ++j) {
    const int mirror = skeleton.mirror[static_cast<std::size_t>(j)];
    const tuning::SystematicOffset& offset = OffsetOf(j);
    Rng rng(detector_seed, {0x0ff5e7, static_cast<std::uint64_t>(std::min(j, mirror))});
    const Eigen::Vector3d random(rng.Normal(), rng.Normal(), rng.Normal());
    const bool is_left = skeleton.joints[static_cast<std::size_t>(j)].front() == 'L';
    const double outwards = j == mirror ? 0.0 : (is_left ? 1.0 : -1.0);
    offsets[static_cast<std::size_t>(j)] =
        strength * Eigen::Vector3d(offset.spread * random.x(),
                                   outwards * (offset.outwards + offset.spread * random.y()),
                                   offset.up + offset.spread * random.z());
  }
  return offsets;
}

/// The landmarks at a time between frames, by linear interpolation; before the first and after the last frame, the
/// landmarks of that frame.
void LandmarksAt(const LandmarkTrack& track, double frame, Eigen::Vector3d* landmarks) {
  const double clamped = std::clamp(frame, 0.0, static_cast<double>(track.frame_count() - 1));
  const auto before = static_cast<int>(clamped);
  const int after = std::min(before + 1, track.frame_count() - 1);
  const double share = clamped - before;
  for (int j = 0; j < kLandmarkCount; ++j) {
    // Exact at the time of a frame.
    landmarks[j] =
        share > 0.0 ? ((1.0 - share) * track.At(before, j) + share * track.At(after, j)).eval() : track.At(before, j);
  }
}

void MapJoints(const LayoutMapping& mapping, const Eigen::Vector3d* landmarks, Eigen::Vector3d* joints) {
  for (std::size_t j = 0; j < mapping.joints.size(); ++j) {
    const std::vector<int>& sources = mapping.joints[j].sources;
    joints[j] = landmarks[sources.front()];
    if (sources.size() == 1) continue;
    for (std::size_t s = 1; s < sources.size(); ++s) joints[j] += landmarks[sources[s]];
    joints[j] /= static_cast<double>(sources.size());
  }
}

bool IsInside(const Eigen::Vector2d& pixel, const std::array<int, 2>& image_size) {
  return pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() < image_size[0] && pixel.y() < image_size[1];
}

/// Observes the track through one camera, frame by frame.
class Viewer {
 public:
  Viewer(const LandmarkTrack& track, const FilmingCamera& camera, const DetectorLayout& layout,
         const DetectorOptions& options, std::uint64_t detector_seed, double late_frames)
      : track_(track),
        camera_(camera),
        mapping_(layout.from_landmarks),
        occlusion_(layout.from_landmarks),
        finds_occlusion_(options.noise * options.occlusion > 0.0),
        has_offsets_(options.joint_offset > 0.0),
        late_frames_(late_frames),
        joints_(mapping_.joints.size()) {
    if (has_offsets_) offsets_ = SystematicOffsets(options.joint_offset, detector_seed);
  }

  void See(int frame, FrameView& view) {
    const Camera& camera = camera_.cameras[camera_.cameras.size() == 1 ? 0 : static_cast<std::size_t>(frame)];
    LandmarksAt(track_, frame + late_frames_, landmarks_.data());
    const double stature_mm = StatureMm(landmarks_.data());
    const Eigen::Matrix3d axes = TrunkAxes(landmarks_.data());
    const Eigen::Vector3d centre =
        -camera.camera_from_world_rotation.transpose() * camera.camera_from_world_translation;
    view.image_size = camera_.image_size;
    view.seconds = frame / track_.fps;
    view.height_px = ImageHeightPx(camera, landmarks_.data());
    view.facing = (centre - landmarks_[kHip]).normalized().dot(axes.col(0));
    MapJoints(mapping_, landmarks_.data(), joints_.data());
    view.hidden.assign(joints_.size(), 0);
    if (finds_occlusion_) {
      occlusion_.Find(landmarks_.data(), joints_.data(), centre, stature_mm, view.hidden.data());
    }
    if (has_offsets_) {
      std::array<Eigen::Vector3d, kLandmarkCount> displaced = landmarks_;
      for (std::size_t j = 0; j < displaced.size(); ++j) {
        displaced[j] += stature_mm * (OffsetAxes(static_cast<int>(j), landmarks_.data(), axes) * offsets_[j]);
      }
      MapJoints(mapping_, displaced.data(), joints_.data());
    }
    previous_.swap(view.pixels);
    view.pixels.resize(joints_.size());
    view.speed.assign(joints_.size(), 0.0);
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      view.pixels[j] = camera.Project(joints_[j]);
      if (frame == 0) continue;
      const double speed = (view.pixels[j] - previous_[j]).norm() * track_.fps / view.height_px;
      if (std::isfinite(speed)) view.speed[j] = speed;
    }
  }

 private:
  const LandmarkTrack& track_;
  const FilmingCamera& camera_;
  const LayoutMapping& mapping_;
  OcclusionTest occlusion_;
  bool finds_occlusion_;
  bool has_offsets_;
  double late_frames_;
  std::array<Eigen::Vector3d, kLandmarkCount> offsets_;
  std::array<Eigen::Vector3d, kLandmarkCount> landmarks_;
  std::vector<Eigen::Vector3d> joints_;
  std::vector<Eigen::Vector2d> previous_;
};

/// Writes a frame's detections; joints outside the image are not found.
void Store(const FrameView& view, const FrameDetections& found, std::size_t frame, Detections& detections) {
  const std::size_t count = view.pixels.size();
  for (std::size_t j = 0; j < count; ++j) {
    const std::size_t at = frame * count + j;
    std::uint8_t errors = found.errors[j];
    const bool is_outside = !IsInside(view.pixels[j], view.image_size);
    if (is_outside) errors = kOutsideImage;
    const bool is_missing = is_outside || (errors & kMissed) != 0;
    const Eigen::Vector2d& pixel = found.pixels[j];
    detections.keypoints[2 * at] = is_missing ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(pixel.x());
    detections.keypoints[2 * at + 1] =
        is_missing ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(pixel.y());
    detections.confidence[at] = is_missing ? 0.0F : static_cast<float>(found.confidence[j]);
    detections.errors[at] = errors;
  }
}

}  // namespace

void DetectorOptions::Validate() const {
  struct Strength {
    const char* name;
    double value;
    double max;
  };
  const std::array<Strength, 10> strengths = {{{"noise", noise, kMaxStrength},
                                               {"jitter", jitter, kMaxStrength},
                                               {"occlusion", occlusion, kMaxStrength},
                                               {"swaps", swaps, kMaxStrength},
                                               {"outliers", outliers, kMaxStrength},
                                               {"missed_joints", missed_joints, kMaxStrength},
                                               {"missed_frames", missed_frames, kMaxStrength},
                                               {"confidence", confidence, kMaxStrength},
                                               {"joint_offset", joint_offset, kMaxStrength},
                                               {"sync_jitter", sync_jitter, kMaxSyncFrames}}};
  for (const Strength& strength : strengths) {
    if (!(strength.value >= 0.0 && strength.value <= strength.max)) {
      ThrowInvalidArgument("`{}` {} is out of range; give 0 to {}", strength.name, strength.value, strength.max);
    }
  }
}

DetectorLayout MakeDetectorLayout(const Skeleton& layout) { return {MapLayout(LandmarkSkeleton(), layout)}; }

std::vector<Eigen::Vector3d> JointPositions(const LandmarkTrack& track, const DetectorLayout& layout) {
  const std::size_t count = layout.from_landmarks.joints.size();
  std::vector<Eigen::Vector3d> positions(static_cast<std::size_t>(track.frame_count()) * count);
  for (int t = 0; t < track.frame_count(); ++t) {
    MapJoints(layout.from_landmarks, &track.At(t, 0), &positions[static_cast<std::size_t>(t) * count]);
  }
  return positions;
}

double ImageHeightPx(const Camera& camera, const Eigen::Vector3d* landmarks) {
  const double depth_mm = std::abs(camera.InCamera(landmarks[kHip]).z());
  return StatureMm(landmarks) * std::sqrt(camera.K(0, 0) * camera.K(1, 1)) / std::max(depth_mm, 1.0);
}

Detections Detect(const LandmarkTrack& track, const FilmingCamera& camera, const DetectorLayout& layout,
                  const DetectorOptions& options, std::uint64_t detector_seed, Rng rng) {
  options.Validate();
  const auto frames = static_cast<std::size_t>(track.frame_count());
  CANONPOSE_CHECK(track.fps > 0.0, "clip {} has {} frames per second", track.name, track.fps);
  const std::size_t count = layout.from_landmarks.joints.size();
  CANONPOSE_CHECK(camera.cameras.size() == 1 || camera.cameras.size() >= frames, "{} cameras for {} frames",
                  camera.cameras.size(), frames);
  Detections detections;
  detections.keypoints.resize(frames * count * 2);
  detections.confidence.resize(frames * count);
  detections.errors.resize(frames * count);
  const double late_frames = options.sync_jitter * Rng(rng.Bits()).Normal();
  Viewer viewer(track, camera, layout, options, detector_seed, late_frames);
  ErrorProcess errors(layout, options, track.fps, rng);
  const bool is_exact = options.noise == 0.0;
  FrameView view;
  FrameDetections found;
  for (std::size_t t = 0; t < frames; ++t) {
    viewer.See(static_cast<int>(t), view);
    if (is_exact) {
      found.pixels = view.pixels;
      found.confidence.assign(count, 1.0);
      found.errors.assign(count, 0);
    } else {
      errors.Next(view, found);
    }
    Store(view, found, t, detections);
  }
  return detections;
}

}  // namespace canonpose
