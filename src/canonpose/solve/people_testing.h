// For tests only: several simulated people before the same cameras, as the tracks of a detector that loses and confuses
// them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "canonpose/base/random.h"
#include "canonpose/data/dataset.h"
#include "canonpose/solve/solve_testing.h"
#include "canonpose/solve/tracklets.h"

namespace canonpose::testing {

struct Crowd {
  Dataset apart;                                   ///< the truth: one sequence per person
  Sequence together;                               ///< the same as tracks
  std::vector<std::vector<std::vector<int>>> who;  ///< [view][track][frame] the person; -1 where the track is empty
};

/// `people` before four static cameras for a few seconds.
inline SimulationOptions SmallCrowd(int people) {
  SimulationOptions options;
  options.activities = {Activity::kGait, Activity::kGesture, Activity::kDance};
  options.subjects = people;
  options.people = people;
  options.clips = 1;
  options.seconds = 6.0;
  options.fps = 25.0;
  options.rig.distance_m = 7.0;
  options.seed = 11;
  return options;
}

/// Every two seconds or so each camera's tracks go on under other numbers, and tracks exchange people now and then.
inline Crowd MakeCrowd(const SimulationOptions& options) {
  Crowd crowd;
  crowd.apart = Simulate(options).dataset;
  const std::vector<Sequence>& people = crowd.apart.sequences;
  const std::size_t joints = crowd.apart.skeleton.joints.size();
  const auto frames = static_cast<std::size_t>(people.front().frame_count);
  crowd.together = people.front();
  crowd.together.name = "hall";
  for (std::size_t v = 0; v < crowd.together.cameras.size(); ++v) {
    CameraView& view = crowd.together.cameras[v];
    view.truth = {};
    view.keypoints.assign(frames * joints * 2, std::nanf(""));
    view.confidence.assign(frames * joints, 0.0F);
    std::vector<std::vector<int>>& who = crowd.who.emplace_back();
    Rng rng(options.seed, {v});
    std::size_t until = 0;
    std::vector<std::size_t> order;
    const auto begin_tracks = [&](std::size_t t) {
      until = t + static_cast<std::size_t>(rng.Uniform(40.0, 70.0));
      order.clear();
      for (std::size_t p = 0; p < people.size(); ++p) {
        order.push_back(view.tracks.size());
        view.tracks.push_back({std::to_string(view.tracks.size()), view.keypoints, view.confidence});
        who.emplace_back(frames, -1);
      }
    };
    for (std::size_t t = 0; t < frames; ++t) {
      if (t == until) begin_tracks(t);
      if (rng.Uniform() < 0.01) std::swap(order.front(), order.back());
      for (std::size_t p = 0; p < people.size(); ++p) {
        const CameraView& from = people[p].cameras[v];
        CameraTrack& track = view.tracks[order[p]];
        bool is_seen = false;
        for (std::size_t i = t * joints; i < (t + 1) * joints; ++i) {
          track.confidence[i] = from.confidence[i];
          track.keypoints[2 * i] = from.keypoints[2 * i];
          track.keypoints[2 * i + 1] = from.keypoints[2 * i + 1];
          is_seen = is_seen || from.confidence[i] > 0.0F;
        }
        if (is_seen) who[order[p]][t] = static_cast<int>(p);
      }
    }
  }
  return crowd;
}

/// The person whom a lane shows.
inline int WhoIs(const Crowd& crowd, const Lanes& lanes, int lane, int view, int frame) {
  const int tracklet = lanes.Owner(lane, view, frame);
  if (tracklet < 0) return -1;
  const auto track = static_cast<std::size_t>(lanes.tracklets[static_cast<std::size_t>(tracklet)].track);
  return crowd.who[static_cast<std::size_t>(view)][track][static_cast<std::size_t>(frame)];
}

/// What a lifter might find in the lanes: NoisyTruth() of the person whom each shows.
inline StartPoses StartOfLanes(const Crowd& crowd, const Lanes& lanes, const StartErrors& errors = {}) {
  const StartPoses truth = NoisyTruth(crowd.apart, errors);
  StartPoses start;
  const Skeleton& skeleton = crowd.apart.skeleton;
  const std::size_t values =
      3 * static_cast<std::size_t>(lanes.frame_count) * static_cast<std::size_t>(skeleton.joint_count());
  for (int lane = 0; lane < lanes.lane_count; ++lane) {
    start.sequences.emplace_back();
    for (int v = 0; v < lanes.view_count; ++v) {
      PoseSequence poses = PosesAboutRoot(skeleton, std::vector<float>(values, std::nanf("")),
                                          crowd.together.cameras[static_cast<std::size_t>(v)].name);
      for (int t = 0; t < lanes.frame_count; ++t) {
        const int person = WhoIs(crowd, lanes, lane, v, t);
        if (person < 0) continue;
        poses.PoseAt(t) = truth.sequences[static_cast<std::size_t>(person)][static_cast<std::size_t>(v)].PoseAt(t);
      }
      start.sequences.back().push_back(std::move(poses));
    }
  }
  return start;
}

/// Of poses, that is frames in which two views or more show a person: how many are of one true person in all views, the
/// one who the person found is most of the time.
struct IdentityCount {
  int poses = 0;
  int right = 0;
};

inline IdentityCount CountRight(const Crowd& crowd, const Lanes& lanes, const Person& person) {
  std::vector<int> counts(crowd.apart.sequences.size(), 0);
  const auto visit = [&](int t, auto&& each) {
    for (int v = 0; v < lanes.view_count; ++v) {
      if (person.At(t, v) >= 0) each(WhoIs(crowd, lanes, person.At(t, v), v, t));
    }
  };
  for (int t = 0; t < lanes.frame_count; ++t) visit(t, [&](int who) { ++counts[static_cast<std::size_t>(who)]; });
  const auto identity = static_cast<int>(std::ranges::max_element(counts) - counts.begin());
  IdentityCount result;
  for (int t = 0; t < lanes.frame_count; ++t) {
    if (person.ViewsAt(t) < 2) continue;
    bool is_right = true;
    visit(t, [&](int who) { is_right = is_right && who == identity; });
    ++result.poses;
    result.right += is_right ? 1 : 0;
  }
  return result;
}

}  // namespace canonpose::testing
