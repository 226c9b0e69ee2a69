#include "canonpose/pipeline/identify_people.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/base/parallel.h"
#include "canonpose/data/calibration_check.h"
#include "canonpose/pipeline/lifter_start.h"
#include "canonpose/solve/identities.h"
#include "canonpose/solve/serial_linear_algebra.h"

namespace canonpose {
namespace {

/// Only a lifter sees in one view alone how somebody stands.
void RequireLifter(const Dataset& dataset, const BootstrapOptions& options) {
  const bool is_lifter = !options.model.empty() || options.kind == "starter" ||
                         (options.kind == "auto" && StarterCanStart(dataset.skeleton));
  if (is_lifter) return;
  ThrowInvalidArgument(
      "`bootstrap`: expected the starter, or a `model` of a lifter, which finding out who is who among several people "
      "needs, found {}; otherwise import the people one by one with `person`",
      options.kind);
}

PeopleReport ReportOf(const Sequence& sequence, const FoundPeople& found, const std::vector<std::string>& names) {
  PeopleReport report;
  report.scene = sequence.name;
  report.frames = sequence.frame_count;
  report.left_out = found.left_out;
  report.explained_percent = 100.0 * found.explained;
  for (std::size_t p = 0; p < found.people.size(); ++p) {
    const FoundPerson& person = found.people[p];
    PersonReport& own = report.people.emplace_back();
    own.name = names[p];
    own.frames = person.frames;
    for (std::size_t v = 0; v < sequence.cameras.size(); ++v) {
      own.frames_of_camera.emplace_back(sequence.cameras[v].name, person.frames_of_view[v]);
    }
    own.reprojection_percent = 100.0 * person.error;
    own.sure_percent = 100.0 * person.sure;
  }
  return report;
}

/// A sequence of each person, and the start of each.
struct Separated {
  std::vector<Sequence> sequences;
  StartPoses start;
  PeopleReport report;
};

Separated Separate(const Skeleton& skeleton, const Sequence& sequence, const std::string& file,
                   const BootstrapOptions& options) {
  Lanes lanes = MakeLanes(skeleton, sequence);
  const StartPoses start = Bootstrap(lanes.dataset, file, options);
  const PeopleObservations people = CollectPeople(std::move(lanes), start);
  FoundPeople found = FindPeople(people, {ThreadsToUse(options.threads), start.knows_depth_sign});
  Separated separated;
  separated.start.knows_depth_sign = start.knows_depth_sign;
  std::vector<std::string> names;
  for (const FoundPerson& person : found.people) {
    names.push_back(fmt::format("{}-person{}", sequence.name, names.size() + 1));
    separated.sequences.push_back(SequenceOf(people.lanes, person.person, sequence, names.back()));
    separated.start.sequences.push_back(StartOf(people.lanes, person.person, start));
  }
  separated.report = ReportOf(sequence, found, names);
  return separated;
}

}  // namespace

IdentifiedPeople IdentifyPeople(Dataset& dataset, const std::string& file, const BootstrapOptions& options) {
  IdentifiedPeople identified;
  if (std::ranges::none_of(dataset.sequences, &Sequence::HasTracks)) {
    identified.start = Bootstrap(dataset, file, options);
    return identified;
  }
  RequireLifter(dataset, options);
  const OneBlasThread one_thread;
  std::vector<Sequence> sequences;
  for (Sequence& sequence : dataset.sequences) {
    Separated separated;
    if (sequence.HasTracks()) {
      if (!sequence.static_cameras) {
        ThrowBadInput({file, "/sequences/" + sequence.name, "static cameras, where several people are told apart",
                       "moving ones", "import the people one by one with `person`"});
      }
      if (sequence.timing == FrameTiming::kOwn) {
        ThrowBadInput({file, "/sequences/" + sequence.name, "synchronised cameras, where several people are told apart",
                       "cameras that began at different times", "import the people one by one with `person`"});
      }
      if (sequence.cameras.size() < 2) {
        ThrowBadInput({file, "/sequences/" + sequence.name, "at least two cameras", "one",
                       "import the views of all cameras together"});
      }
      separated = Separate(dataset.skeleton, sequence, file, options);
      identified.people.push_back(std::move(separated.report));
    } else {
      Dataset single;
      single.skeleton = dataset.skeleton;
      single.source = dataset.source;
      single.sequences = {sequence};
      separated.start = Bootstrap(single, file, options);
      separated.sequences = {std::move(sequence)};
    }
    identified.start.knows_depth_sign = identified.start.knows_depth_sign && separated.start.knows_depth_sign;
    std::ranges::move(separated.sequences, std::back_inserter(sequences));
    std::ranges::move(separated.start.sequences, std::back_inserter(identified.start.sequences));
  }
  dataset.sequences = std::move(sequences);
  // At import nothing said which keypoints belong together.
  if (dataset.HasCalibration()) CheckCalibration(dataset, file);
  return identified;
}

}  // namespace canonpose
