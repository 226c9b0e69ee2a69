#include "canonpose/solve/tracklets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "canonpose/base/error.h"

namespace canonpose {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();
constexpr double kUsualFps = 30.0;
constexpr double kLongestGapSeconds = 0.5;

bool ShowsAnything(const CameraTrack& track, int frame, std::size_t joints) {
  const auto begin = track.confidence.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(frame) * joints);
  return std::any_of(begin, begin + static_cast<std::ptrdiff_t>(joints), [](float c) { return c > 0.0F; });
}

/// The tracklets of one track; their lanes are not known yet.
std::vector<Tracklet> CutTrack(const CameraTrack& track, int view, int number, int frame_count, double fps,
                               std::size_t joints) {
  const int longest_gap = std::max(1, static_cast<int>(std::lround(kLongestGapSeconds * fps)));
  std::vector<Tracklet> tracklets;
  for (int t = 0; t < frame_count; ++t) {
    if (!ShowsAnything(track, t, joints)) continue;
    if (tracklets.empty() || t - tracklets.back().last > longest_gap) {
      tracklets.push_back({view, number, 0, t, t});
    }
    tracklets.back().last = t;
  }
  return tracklets;
}

/// Copies frames `first` .. `last` of rows of `width` values.
void CopyRows(const std::vector<float>& from, std::size_t width, const Tracklet& tracklet, std::vector<float>& to) {
  const auto begin = static_cast<std::ptrdiff_t>(width) * tracklet.first;
  const auto end = static_cast<std::ptrdiff_t>(width) * (tracklet.last + 1);
  std::copy(from.begin() + begin, from.begin() + end, to.begin() + begin);
}

/// The first lane of the view that is empty from the tracklet's first frame on; tracklets come in the order of these.
int FindLane(const Tracklet& tracklet, std::vector<int>& free_from) {
  const auto lane = std::ranges::find_if(free_from, [&](int frame) { return frame <= tracklet.first; });
  const auto number = lane - free_from.begin();
  if (lane == free_from.end()) free_from.push_back(0);
  free_from[static_cast<std::size_t>(number)] = tracklet.last + 1;
  return static_cast<int>(number);
}

/// A sequence like this one whose cameras have seen nothing.
Sequence EmptyLike(const Sequence& sequence, std::size_t joints) {
  Sequence empty;
  empty.name = sequence.name;
  empty.subject = sequence.subject;
  empty.fps = sequence.fps;
  empty.static_cameras = sequence.static_cameras;
  empty.capture = sequence.capture;
  empty.capture_is_named = true;
  empty.frame_count = sequence.frame_count;
  const std::size_t values = static_cast<std::size_t>(sequence.frame_count) * joints;
  for (const CameraView& camera : sequence.cameras) {
    CameraView& view = empty.cameras.emplace_back();
    view.name = camera.name;
    view.image_size = camera.image_size;
    view.calibration = camera.calibration;
    view.keypoints.assign(2 * values, kMissing);
    view.confidence.assign(values, 0.0F);
  }
  return empty;
}

std::vector<Tracklet> TrackletsOf(const Sequence& sequence, double fps, std::size_t joints) {
  std::vector<Tracklet> tracklets;
  for (std::size_t v = 0; v < sequence.cameras.size(); ++v) {
    const std::vector<CameraTrack>& tracks = sequence.cameras[v].tracks;
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      const std::vector<Tracklet> cut =
          CutTrack(tracks[i], static_cast<int>(v), static_cast<int>(i), sequence.frame_count, fps, joints);
      tracklets.insert(tracklets.end(), cut.begin(), cut.end());
    }
  }
  std::ranges::stable_sort(tracklets, {}, &Tracklet::first);
  return tracklets;
}

}  // namespace

Lanes MakeLanes(const Skeleton& skeleton, const Sequence& sequence) {
  const std::size_t joints = skeleton.joints.size();
  Lanes lanes;
  lanes.view_count = static_cast<int>(sequence.cameras.size());
  lanes.frame_count = sequence.frame_count;
  lanes.fps = sequence.fps > 0.0 ? sequence.fps : kUsualFps;
  lanes.tracklets = TrackletsOf(sequence, lanes.fps, joints);
  std::vector<std::vector<int>> free_from(sequence.cameras.size());
  for (Tracklet& tracklet : lanes.tracklets) {
    tracklet.lane = FindLane(tracklet, free_from[static_cast<std::size_t>(tracklet.view)]);
    lanes.lane_count = std::max(lanes.lane_count, tracklet.lane + 1);
  }
  lanes.dataset.skeleton = skeleton;
  for (int lane = 0; lane < lanes.lane_count; ++lane) {
    Sequence& empty = lanes.dataset.sequences.emplace_back(EmptyLike(sequence, joints));
    empty.static_cameras = true;
    empty.subject = empty.name = "lane " + std::to_string(lane);
    for (CameraView& view : empty.cameras) view.calibration.clear();
  }
  const auto frames = static_cast<std::size_t>(lanes.frame_count);
  lanes.owner.assign(static_cast<std::size_t>(lanes.lane_count * lanes.view_count) * frames, -1);
  for (std::size_t i = 0; i < lanes.tracklets.size(); ++i) {
    const Tracklet& tracklet = lanes.tracklets[i];
    const auto v = static_cast<std::size_t>(tracklet.view);
    const CameraTrack& track = sequence.cameras[v].tracks[static_cast<std::size_t>(tracklet.track)];
    CameraView& view = lanes.dataset.sequences[static_cast<std::size_t>(tracklet.lane)].cameras[v];
    CopyRows(track.keypoints, 2 * joints, tracklet, view.keypoints);
    CopyRows(track.confidence, joints, tracklet, view.confidence);
    for (int t = tracklet.first; t <= tracklet.last; ++t) {
      if (!ShowsAnything(track, t, joints)) continue;
      lanes.owner[static_cast<std::size_t>(tracklet.lane * lanes.view_count + tracklet.view) * frames +
                  static_cast<std::size_t>(t)] = static_cast<int>(i);
    }
  }
  return lanes;
}

PeopleObservations CollectPeople(Lanes lanes, const StartPoses& start) {
  std::vector<CaptureObservations> captures = CollectCaptures(lanes.dataset, start);
  CANONPOSE_CHECK(captures.size() == 1, "{} captures", captures.size());
  return {std::move(captures.front()), std::move(lanes)};
}

int Person::ViewsAt(int frame) const {
  int views = 0;
  for (int v = 0; v < view_count_; ++v) views += At(frame, v) >= 0 ? 1 : 0;
  return views;
}

std::vector<int> Person::FramesWith(int views) const {
  std::vector<int> frames;
  const auto count = view_count_ > 0 ? static_cast<int>(lanes.size()) / view_count_ : 0;
  for (int t = 0; t < count; ++t) {
    if (ViewsAt(t) >= views) frames.push_back(t);
  }
  return frames;
}

CaptureObservations AssembleCapture(const PeopleObservations& people, std::span<const Person> persons,
                                    std::span<const std::vector<int>> frames) {
  CANONPOSE_CHECK(persons.size() == frames.size(), "{} persons, {} lists of frames", persons.size(), frames.size());
  const CaptureObservations& all = people.capture;
  CaptureObservations capture;
  capture.name = all.name;
  capture.skeleton = all.skeleton;
  capture.dataset_joints = all.dataset_joints;
  capture.unseen_joints = all.unseen_joints;
  capture.static_cameras = true;
  capture.cameras = all.cameras;
  for (std::size_t p = 0; p < persons.size(); ++p) {
    const auto count = static_cast<int>(frames[p].size());
    capture.clips.push_back({p, capture.frame_count, count, people.lanes.fps, static_cast<int>(p)});
    capture.subjects.push_back(std::to_string(p));
    capture.frame_count += count;
  }
  const std::size_t values = capture.Index(capture.frame_count, 0, 0);
  capture.xy.assign(2 * values, kMissing);
  capture.confidence.assign(values, 0.0F);
  capture.start.assign(3 * values, kMissing);
  const auto joints = static_cast<std::ptrdiff_t>(capture.joint_count());
  const auto copy = [&](const std::vector<float>& from, std::size_t at, std::vector<float>& to, std::size_t place,
                        std::ptrdiff_t width) {
    const auto begin = from.begin() + width * static_cast<std::ptrdiff_t>(at);
    std::copy(begin, begin + width * joints, to.begin() + width * static_cast<std::ptrdiff_t>(place));
  };
  for (std::size_t p = 0; p < persons.size(); ++p) {
    for (std::size_t i = 0; i < frames[p].size(); ++i) {
      for (int v = 0; v < capture.view_count(); ++v) {
        const int lane = persons[p].At(frames[p][i], v);
        if (lane < 0) continue;
        const std::size_t at = all.Index(people.FrameOf(lane, frames[p][i]), v, 0);
        const std::size_t place = capture.Index(capture.clips[p].first + static_cast<int>(i), v, 0);
        copy(all.xy, at, capture.xy, place, 2);
        copy(all.confidence, at, capture.confidence, place, 1);
        copy(all.start, at, capture.start, place, 3);
      }
    }
  }
  return capture;
}

Sequence SequenceOf(const Lanes& lanes, const Person& person, const Sequence& sequence, const std::string& name) {
  const std::size_t joints = lanes.dataset.skeleton.joints.size();
  Sequence own = EmptyLike(sequence, joints);
  own.name = own.subject = name;
  own.scene = sequence.name;
  for (int v = 0; v < lanes.view_count; ++v) {
    CameraView& view = own.cameras[static_cast<std::size_t>(v)];
    for (int t = 0; t < lanes.frame_count; ++t) {
      const int lane = person.At(t, v);
      if (lane < 0) continue;
      const CameraView& from =
          lanes.dataset.sequences[static_cast<std::size_t>(lane)].cameras[static_cast<std::size_t>(v)];
      const Tracklet row{.first = t, .last = t};
      CopyRows(from.keypoints, 2 * joints, row, view.keypoints);
      CopyRows(from.confidence, joints, row, view.confidence);
    }
  }
  return own;
}

std::vector<PoseSequence> StartOf(const Lanes& lanes, const Person& person, const StartPoses& start) {
  std::vector<PoseSequence> poses;
  for (int v = 0; v < lanes.view_count; ++v) {
    const auto view = static_cast<std::size_t>(v);
    PoseSequence own;
    for (int t = 0; t < lanes.frame_count; ++t) {
      const int lane = person.At(t, v);
      if (lane < 0) continue;
      const PoseSequence& from = start.sequences.at(static_cast<std::size_t>(lane)).at(view);
      if (from.empty()) continue;
      if (own.empty()) {
        own = PosesAboutRoot(from.skeleton(), std::vector<float>(from.positions().size(), kMissing),
                             from.coordinate_frame.camera);
      }
      own.PoseAt(t) = from.PoseAt(t);
    }
    own.TrustKnownJoints();
    poses.push_back(std::move(own));
  }
  return poses;
}

}  // namespace canonpose
