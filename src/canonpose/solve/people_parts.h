// From people who were followed through a recording to those who were there: parts of one person are joined, and what
// is no person is left out.
#pragma once

#include <string>
#include <vector>

#include "canonpose/solve/camera_rays.h"
#include "canonpose/solve/tracklets.h"

namespace canonpose {

/// Joins people of whom one appears after the other has gone, where tracklets or bone lengths and elimination say that
/// they are one.
std::vector<Person> JoinParts(const PeopleObservations& people, const CameraRays& rays, std::vector<Person> persons);

/// Takes out what is too short, or fits too badly, to be a person, and says so in one line each.
std::vector<std::string> LeaveOutFalsePeople(const PeopleObservations& people, const CameraRays& rays,
                                             std::vector<Person>& persons);

/// The mean distance of a person's keypoints from the joints that all views show, in some frames that two views or more
/// show; each 1 at most, in units of 0.05 body units. 1 where there are no such frames.
double MeanMisfit(const PeopleObservations& people, const CameraRays& rays, const Person& person);

/// Share of a person's sightings whose place no other sighting of the view could take.
double ShareWithoutRival(const PeopleObservations& people, const CameraRays& rays, const Person& person);

}  // namespace canonpose
