#include "canonpose/solve/observations.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "canonpose/base/error.h"

namespace canonpose {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr double kDefaultFps = 30.0;

/// Adds the camera of a view to the capture unless it is there already.
void AddCamera(CaptureObservations& capture, const CameraView& view, const Sequence& sequence) {
  const int known = capture.FindView(view.name);
  if (known < 0) {
    capture.cameras.push_back(
        {view.name, view.image_size, view.image_size, std::hypot(view.image_size[0], view.image_size[1])});
    return;
  }
  const std::array<int, 2>& size_px = capture.cameras[static_cast<std::size_t>(known)].declared_size_px;
  if (size_px != view.image_size) {
    ThrowBadInput({sequence.name, fmt::format("camera {}", view.name),
                   fmt::format("images of {} x {} as in the capture's other sequences", size_px[0], size_px[1]),
                   fmt::format("{} x {}", view.image_size[0], view.image_size[1]),
                   "give sequences with other cameras another `capture`"});
  }
}

void FillView(CaptureObservations& capture, const ClipRange& clip, int v, const CameraView& view,
              const PoseSequence& start_poses) {
  const std::vector<float>& start = start_poses.positions();
  const auto joints = static_cast<std::size_t>(capture.joint_count());
  const ObservedCamera& camera = capture.cameras[static_cast<std::size_t>(v)];
  const std::array<double, 2> centre = {0.5 * camera.image_size_px[0], 0.5 * camera.image_size_px[1]};
  for (int frame = 0; frame < clip.count; ++frame) {
    const std::size_t to = capture.Index(clip.first + frame, v, 0);
    const std::size_t from = static_cast<std::size_t>(frame) * joints;
    for (std::size_t j = 0; j < joints; ++j) {
      const float x = view.keypoints[2 * (from + j)];
      const float y = view.keypoints[2 * (from + j) + 1];
      if (!(view.confidence[from + j] > 0.0F) || !std::isfinite(x) || !std::isfinite(y)) continue;
      capture.confidence[to + j] = view.confidence[from + j];
      capture.xy[2 * (to + j)] = static_cast<float>((x - centre[0]) / camera.diagonal_px);
      capture.xy[2 * (to + j) + 1] = static_cast<float>((y - centre[1]) / camera.diagonal_px);
    }
    if (start.empty()) continue;
    const auto root = static_cast<std::size_t>(capture.skeleton.root);
    double squares = 0.0;
    for (std::size_t i = 0; i < 3 * joints; ++i) {
      if (std::isfinite(start[3 * from + i])) squares += std::pow(start[3 * from + i], 2);
    }
    if (!std::isfinite(start[3 * (from + root)]) || squares <= 0.0) continue;
    for (std::size_t i = 0; i < 3 * joints; ++i) {
      const float value = start[3 * from + i];
      capture.start[3 * to + i] = std::isfinite(value) ? static_cast<float>(value / std::sqrt(squares)) : 0.0F;
    }
  }
}

/// Leaves out joints that no view sees in any frame. Nothing is known of them but what the start's poses make up.
void RemoveUnseenJoints(CaptureObservations& capture) {
  const CaptureObservations full = capture;
  std::vector<bool> is_seen(full.skeleton.joints.size(), false);
  for (std::size_t i = 0; i < full.confidence.size(); ++i) {
    if (full.confidence[i] > 0.0F) is_seen[i % is_seen.size()] = true;
  }
  capture.dataset_joints.clear();
  for (int j = 0; j < full.joint_count(); ++j) {
    if (is_seen[static_cast<std::size_t>(j)] || j == full.skeleton.root) {
      capture.dataset_joints.push_back(j);
    } else {
      capture.unseen_joints.push_back(full.skeleton.joints[static_cast<std::size_t>(j)]);
    }
  }
  if (capture.unseen_joints.empty()) return;
  capture.skeleton = Subset(full.skeleton, capture.dataset_joints);
  const auto keep = [&](std::vector<float>& values, const std::vector<float>& all, std::size_t width) {
    values.clear();
    for (std::size_t row = 0; row < all.size() / (width * is_seen.size()); ++row) {
      for (const int j : capture.dataset_joints) {
        const auto from =
            all.begin() + static_cast<std::ptrdiff_t>(width * (row * is_seen.size() + static_cast<std::size_t>(j)));
        values.insert(values.end(), from, from + static_cast<std::ptrdiff_t>(width));
      }
    }
  };
  keep(capture.xy, full.xy, 2);
  keep(capture.confidence, full.confidence, 1);
  keep(capture.start, full.start, 3);
}

int SubjectIndex(CaptureObservations& capture, const std::string& subject) {
  const auto found = std::find(capture.subjects.begin(), capture.subjects.end(), subject);
  if (found != capture.subjects.end()) return static_cast<int>(found - capture.subjects.begin());
  capture.subjects.push_back(subject);
  return static_cast<int>(capture.subjects.size()) - 1;
}

}  // namespace

int CaptureObservations::FindView(std::string_view camera) const {
  const auto found = std::ranges::find(cameras, camera, &ObservedCamera::name);
  return found == cameras.end() ? -1 : static_cast<int>(found - cameras.begin());
}

bool CaptureObservations::HasStart(int frame, int view) const {
  return Sees(frame, view, skeleton.root) && std::isfinite(start[3 * Index(frame, view, 0)]);
}

Points3d CaptureObservations::StartOf(int frame, int view) const {
  using Rows = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
  return Eigen::Map<const Rows>(&start[3 * Index(frame, view, 0)], joint_count(), 3).cast<double>();
}

const ClipRange& CaptureObservations::ClipOf(int frame) const {
  const auto after =
      std::upper_bound(clips.begin(), clips.end(), frame, [](int f, const ClipRange& clip) { return f < clip.first; });
  return *(after - 1);
}

std::vector<CaptureObservations> CollectCaptures(const Dataset& dataset, const StartPoses& start) {
  std::vector<CaptureObservations> captures;
  std::map<std::string, std::size_t> static_captures;
  for (std::size_t s = 0; s < dataset.sequences.size(); ++s) {
    const Sequence& sequence = dataset.sequences[s];
    std::size_t index = captures.size();
    if (sequence.static_cameras) index = static_captures.try_emplace(sequence.capture, index).first->second;
    if (index == captures.size()) {
      captures.emplace_back();
      captures.back().name = sequence.static_cameras ? sequence.capture : sequence.name;
      captures.back().skeleton = dataset.skeleton;
      captures.back().static_cameras = sequence.static_cameras;
    }
    CaptureObservations& capture = captures[index];
    capture.clips.push_back({s, capture.frame_count, sequence.frame_count,
                             sequence.fps > 0.0 ? sequence.fps : kDefaultFps, SubjectIndex(capture, sequence.subject),
                             sequence.timing, sequence.fps > 0.0});
    capture.frame_count += sequence.frame_count;
    for (const CameraView& view : sequence.cameras) AddCamera(capture, view, sequence);
  }
  for (CaptureObservations& capture : captures) {
    const std::size_t values = capture.Index(capture.frame_count, 0, 0);
    capture.xy.assign(2 * values, kNaN);
    capture.confidence.assign(values, 0.0F);
    capture.start.assign(3 * values, kNaN);
    for (const ClipRange& clip : capture.clips) {
      const Sequence& sequence = dataset.sequences[clip.sequence];
      for (std::size_t c = 0; c < sequence.cameras.size(); ++c) {
        FillView(capture, clip, capture.FindView(sequence.cameras[c].name), sequence.cameras[c],
                 start.sequences.at(clip.sequence).at(c));
      }
    }
    RemoveUnseenJoints(capture);
  }
  return captures;
}

CaptureObservations SingleClip(const CaptureObservations& capture, int clip) {
  CaptureObservations single = capture;
  const ClipRange range = capture.clips[static_cast<std::size_t>(clip)];
  single.clips = {range};
  single.clips.front().first = 0;
  single.frame_count = range.count;
  const auto slice = [&](std::vector<float>& values, const std::vector<float>& all, std::size_t width) {
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(width * capture.Index(range.first, 0, 0));
    values.assign(begin, begin + static_cast<std::ptrdiff_t>(width * capture.Index(range.count, 0, 0)));
  };
  slice(single.xy, capture.xy, 2);
  slice(single.confidence, capture.confidence, 1);
  slice(single.start, capture.start, 3);
  return single;
}

CaptureObservations SingleFrame(const CaptureObservations& capture, std::span<const int> frame_of_view) {
  CaptureObservations single;
  single.name = capture.name;
  single.skeleton = capture.skeleton;
  single.static_cameras = capture.static_cameras;
  single.cameras = capture.cameras;
  single.frame_count = 1;
  const auto joints = static_cast<std::size_t>(capture.joint_count());
  const std::size_t values = capture.Index(1, 0, 0);
  single.xy.assign(2 * values, kNaN);
  single.confidence.assign(values, 0.0F);
  for (int v = 0; v < capture.view_count(); ++v) {
    const int frame = frame_of_view[static_cast<std::size_t>(v)];
    if (frame < 0) continue;
    const std::size_t from = capture.Index(frame, v, 0);
    const std::size_t to = capture.Index(0, v, 0);
    std::copy_n(&capture.xy[2 * from], 2 * joints, &single.xy[2 * to]);
    std::copy_n(&capture.confidence[from], joints, &single.confidence[to]);
  }
  return single;
}

void SetLens(CaptureObservations& capture, int view, const RadialLens& lens) {
  RadialLens& current = capture.cameras[static_cast<std::size_t>(view)].lens;
  if (lens == current) return;
  for (int n = 0; n < capture.frame_count; ++n) {
    for (int j = 0; j < capture.joint_count(); ++j) {
      const Eigen::Vector2d undistorted = lens.Undistort(current.Distort(capture.At(n, view, j)));
      const std::size_t i = 2 * capture.Index(n, view, j);
      capture.xy[i] = static_cast<float>(undistorted.x());
      capture.xy[i + 1] = static_cast<float>(undistorted.y());
    }
  }
  current = lens;
}

bool HasSameKeypoints(const CaptureObservations& a, const CaptureObservations& b) {
  const auto is_same = [](float x, float y) { return x == y || (std::isnan(x) && std::isnan(y)); };
  return a.confidence == b.confidence && std::ranges::equal(a.xy, b.xy, is_same);
}

}  // namespace canonpose
