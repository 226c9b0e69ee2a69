// A view's camera from people whom other views show.
#pragma once

#include <optional>
#include <span>

#include "canonpose/solve/people_tracker.h"
#include "canonpose/solve/tracklets.h"

namespace canonpose {

/// The camera of `view` with which one of its tracklets shows one of the people best: each tracklet is tried as each
/// person, whose joints in space follow from the other views (Resection). What the view was taken to show before does
/// not count. Nothing where none fits.
std::optional<CameraEstimate> PlaceView(const PeopleObservations& people, const KnownCameras& known,
                                        std::span<const Person> persons, int view);

}  // namespace canonpose
