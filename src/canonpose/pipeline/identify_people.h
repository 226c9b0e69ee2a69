// From a recording of several people to one sequence for each: who is who, and what to solve them from.
#pragma once

#include <string>
#include <vector>

#include "canonpose/data/dataset.h"
#include "canonpose/pipeline/bootstrap.h"
#include "canonpose/solve/observations.h"
#include "canonpose/solve/report.h"

namespace canonpose {

struct IdentifiedPeople {
  StartPoses start;                  ///< of the dataset as it is now
  std::vector<PeopleReport> people;  ///< of every sequence that had tracks
};

/// The start for a dataset (Bootstrap()). Sequences with tracks of several people are first replaced by one sequence
/// for each person, NAME-person1 and so on with the most prominent first: each is its own subject, of the same capture
/// and with the attribute `scene`, the name of the sequence that they come from. `file` is the dataset's name for
/// messages.
///
/// Throws what Bootstrap() throws; Error(kInvalidArgument) where there are tracks and the start is no lifter, and
/// Error(kBadInput) where the cameras of tracks move; Error(kComputation) where no two cameras show people in common.
IdentifiedPeople IdentifyPeople(Dataset& dataset, const std::string& file, const BootstrapOptions& options);

}  // namespace canonpose
