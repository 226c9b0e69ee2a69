// Who is who across static cameras that nobody calibrated.
//
//   1. Each camera's tracks are cut into tracklets (tracklets.h). The start's poses of two tracklets of one person
//   differ
//      by the rotation between the cameras, which is the same for everybody: rotations that many pairs agree on are
//      candidates (start_agreement.h).
//   2. For each candidate, the people whom the poses alone tell apart calibrate the cameras (calibration.h), and
//   everybody
//      is followed through some of the recording with them (people_tracker.h). The candidate that explains most of what
//      the cameras saw wins: cameras that are wrong explain little.
//   3. A view that was placed wrongly is placed by the people whom the others show (view_placement.h), and the people
//      found calibrate the cameras again, better. With these everybody is followed through all frames.
//   4. Parts of one person before and after an absence are joined where nobody else can be meant, and what is too short
//      or fits too badly to be a person is left out (people_parts.h).
#pragma once

#include <string>
#include <vector>

#include "canonpose/solve/tracklets.h"

namespace canonpose {

struct IdentityOptions {
  int threads = 1;               ///< the result does not depend on it
  bool knows_depth_sign = true;  ///< StartPoses::knows_depth_sign
};

/// Somebody who was found.
struct FoundPerson {
  Person person;
  int frames = 0;                   ///< in which two views or more show the person
  std::vector<int> frames_of_view;  ///< (V)
  double error = 0.0;               ///< mean distance of keypoints from the person's joints, body units
  /// Share of sightings whose place nobody else in the view could take: no other person's keypoints fit nearly as well.
  double sure = 0.0;
};

struct FoundPeople {
  std::vector<FoundPerson> people;    ///< the most prominent first
  std::vector<std::string> left_out;  ///< what was not taken for a person, one line each
  double explained = 0.0;             ///< share of all sightings that are somebody's whom two views show
};

/// Finds the people of a sequence. Throws Error(kComputation) where no two views show somebody in common.
FoundPeople FindPeople(const PeopleObservations& people, const IdentityOptions& options);

}  // namespace canonpose
