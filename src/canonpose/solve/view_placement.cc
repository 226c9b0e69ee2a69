#include "canonpose/solve/view_placement.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "canonpose/base/median.h"
#include "canonpose/solve/camera_rays.h"
#include "canonpose/solve/frame_choice.h"
#include "canonpose/solve/resection.h"

namespace canonpose {
namespace {

constexpr int kPlacingFrames = 40;
constexpr int kMinPlacingFrames = 8;
/// Of keypoints, in body units: of a quick calibration.
constexpr double kQuickScatter = 0.01;
/// The median distance of keypoints with which a view still shows the person.
constexpr double kPlacedDistance = 0.025;
/// A placement from few frames is less certain: to its cost comes this divided by the root of their number.
constexpr double kCostOfFewFrames = 1.0;
/// Only people with so many frames that two other views show are tried, and only the longest tracklets.
constexpr std::size_t kTriedPeople = 8;
constexpr std::size_t kTriedTracklets = 24;

/// A person in space by frame; frames that fewer than two of the other views show are empty.
std::vector<JointPositions> JointsWithout(const PeopleObservations& people, const CameraRays& rays,
                                          const Person& person, int view) {
  std::vector<JointPositions> joints(static_cast<std::size_t>(people.lanes.frame_count));
  for (int t = 0; t < people.lanes.frame_count; ++t) {
    const std::vector<ViewSighting> sightings = SightingsOf(people, rays, person, t, view);
    if (sightings.size() >= 2) joints[static_cast<std::size_t>(t)] = rays.Triangulate(sightings);
  }
  return joints;
}

std::vector<Sighting> CommonSightings(const PeopleObservations& people, const std::vector<JointPositions>& joints,
                                      const Tracklet& tracklet) {
  std::vector<int> frames;
  for (int t = tracklet.first; t <= tracklet.last; ++t) {
    if (!joints[static_cast<std::size_t>(t)].empty()) frames.push_back(t);
  }
  std::vector<Sighting> sightings;
  if (static_cast<int>(frames.size()) < kMinPlacingFrames) return sightings;
  const CaptureObservations& capture = people.capture;
  for (const int t : EvenlySpread(frames, kPlacingFrames)) {
    const int n = people.FrameOf(tracklet, t);
    for (int j = 0; j < capture.joint_count(); ++j) {
      const Eigen::Vector3d& joint = joints[static_cast<std::size_t>(t)][static_cast<std::size_t>(j)];
      if (!joint.allFinite() || !capture.Sees(n, tracklet.view, j)) continue;
      sightings.push_back({joint, capture.At(n, tracklet.view, j)});
    }
  }
  return sightings;
}

double MeanLogFocal(const KnownCameras& known) {
  double sum = 0.0;
  int count = 0;
  for (const CameraEstimate& camera : known.cameras) {
    if (!camera.valid) continue;
    sum += camera.log_focal;
    ++count;
  }
  return count > 0 ? sum / count : 0.0;
}

std::vector<const Tracklet*> LongestTracklets(const PeopleObservations& people, int view) {
  std::vector<const Tracklet*> tracklets;
  for (const Tracklet& tracklet : people.lanes.tracklets) {
    if (tracklet.view == view) tracklets.push_back(&tracklet);
  }
  std::ranges::stable_sort(
      tracklets, [](const Tracklet* a, const Tracklet* b) { return a->last - a->first > b->last - b->first; });
  if (tracklets.size() > kTriedTracklets) tracklets.resize(kTriedTracklets);
  return tracklets;
}

}  // namespace

std::optional<CameraEstimate> PlaceView(const PeopleObservations& people, const KnownCameras& known,
                                        std::span<const Person> persons, int view) {
  const CameraRays rays(people.capture, known.cameras);
  const double log_focal = MeanLogFocal(known);
  std::vector<std::pair<std::size_t, const Person*>> tried;  // by their number of frames
  for (const Person& person : persons) tried.emplace_back(person.FramesWith(2).size(), &person);
  std::ranges::stable_sort(tried, std::ranges::greater(), &std::pair<std::size_t, const Person*>::first);
  if (tried.size() > kTriedPeople) tried.resize(kTriedPeople);
  const std::vector<const Tracklet*> tracklets = LongestTracklets(people, view);
  std::optional<CameraEstimate> best;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [frames, person] : tried) {
    const std::vector<JointPositions> joints = JointsWithout(people, rays, *person, view);
    for (const Tracklet* tracklet : tracklets) {
      const std::vector<Sighting> sightings = CommonSightings(people, joints, *tracklet);
      if (sightings.empty()) continue;
      const Resection placed = ResectWithFocal(sightings, log_focal, kQuickScatter);
      if (!placed.valid || !(Median(placed.errors) < kPlacedDistance)) continue;
      const double cost =
          placed.cost + kCostOfFewFrames / std::sqrt(static_cast<double>(tracklet->last - tracklet->first + 1));
      if (cost >= least) continue;
      least = cost;
      best = placed.StaticCamera();
    }
  }
  return best;
}

}  // namespace canonpose
