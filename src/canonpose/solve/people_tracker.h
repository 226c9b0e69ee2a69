// Follows people through a scene in 3D, frame by frame, with static cameras that are known: who is who in every view.
//
// A person is predicted from the frames before, and each view's sightings are assigned to the people whom they fit
// best. The views of one person must agree with each other; one that does not is given to somebody else whom it fits,
// or left alone. Sightings that belong to nobody make a new person where two views agree on them for a while. So a
// detector that takes one person for another, or gives a person a new number, hardly matters: what decides is where
// people are.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "canonpose/solve/camera_rays.h"
#include "canonpose/solve/rig_estimate.h"
#include "canonpose/solve/tracklets.h"

namespace canonpose {

struct FollowedPeople {
  std::vector<Person> persons;  ///< some may be false, and one person may be several, one after the other
  int sightings = 0;            ///< of all views and frames
  int explained = 0;            ///< of these, those of people whom two views or more show in the frame
  int links = 0;                ///< the same less one for each person and frame: how far views agree with each other
  double error = 0.0;           ///< mean distance of what is explained, body units, each counted as 0.05 at most
  /// How good the cameras are, from 0 to 1: links, less what is far off, of those that are possible if everybody is
  /// seen by all `view_count` views.
  [[nodiscard]] double Score(int view_count) const;
};

/// What is known of the cameras: all static.
struct KnownCameras {
  std::vector<CameraEstimate> cameras;  ///< (V)
  double bones = 1.0;                   ///< the sum of the bone lengths of a person
};

/// Follows everybody through `frames` (ascending; neighbours are taken to be close in time).
FollowedPeople FollowPeople(const PeopleObservations& people, const KnownCameras& known, std::span<const int> frames);

/// What the known cameras show of a person in a frame; `without`: a view that is left out, -1 for none.
std::vector<ViewSighting> SightingsOf(const PeopleObservations& people, const CameraRays& rays, const Person& person,
                                      int frame, int without = -1);

/// The joints of a person in a frame from all views; NaN where unknown.
JointPositions JointsOf(const PeopleObservations& people, const CameraRays& rays, const Person& person, int frame);

}  // namespace canonpose
