// Sightings that belong to nobody yet: which of them are one new person.
#pragma once

#include <map>
#include <span>
#include <utility>
#include <vector>

#include "canonpose/solve/camera_rays.h"
#include "canonpose/solve/tracklets.h"

namespace canonpose {

/// A view's sighting of somebody in a frame of the sequence.
struct LaneSighting {
  int view = 0;
  int lane = 0;
  int tracklet = 0;
  int frame = 0;  ///< of the capture
};

class NewPeople {
 public:
  /// All must outlive this.
  NewPeople(const PeopleObservations& people, const CameraRays& rays, double bones);

  /// Groups of sightings, each of a person, of two views or more, from those in `frame` of the sequence.
  [[nodiscard]] std::vector<std::vector<LaneSighting>> Find(std::span<const LaneSighting> sightings, int frame);

 private:
  /// How badly two tracklets fit as one person in the second from `frame` on; from about 0.2 for one, above 1 for two.
  double Cost(const LaneSighting& a, const LaneSighting& b, int frame);
  [[nodiscard]] double CostInFrame(const ViewSighting& a, const ViewSighting& b) const;

  const PeopleObservations& people_;
  const CameraRays& rays_;
  double bones_;
  std::map<std::pair<std::pair<int, int>, int>, double> costs_;  ///< by tracklets and half second
};

}  // namespace canonpose
