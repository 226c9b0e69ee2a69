#include "canonpose/solve/identities.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/median.h"
#include "canonpose/base/parallel.h"
#include "canonpose/base/progress.h"
#include "canonpose/solve/calibration.h"
#include "canonpose/solve/camera_check.h"
#include "canonpose/solve/diagnosis.h"
#include "canonpose/solve/frame_choice.h"
#include "canonpose/solve/people_parts.h"
#include "canonpose/solve/people_tracker.h"
#include "canonpose/solve/start_agreement.h"
#include "canonpose/solve/view_placement.h"

namespace canonpose {
namespace {

constexpr int kProposals = 6;
/// People and frames that calibrate the cameras, first quickly, then better.
constexpr std::size_t kCalibratingPeople = 10;
constexpr int kTrialFrames = 150;
constexpr int kTrialIterations = 25;
constexpr int kBetterFrames = 300;
constexpr int kBetterIterations = 60;
/// Candidates are compared in runs of frames.
constexpr int kTrialRuns = 3;
constexpr int kTrialRunFrames = 300;
constexpr int kFollowRounds = 2;
/// If less than this of what the cameras saw is explained, no candidate is right.
constexpr double kLeastScore = 0.1;
/// So many of the best candidates have their views placed anew, where that explains so much more.
constexpr std::size_t kImproved = 2;
constexpr double kClearGain = 0.01;

/// What one candidate came to.
struct Candidate {
  KnownCameras known;
  bool is_usable = false;
  double score = 0.0;
  std::vector<Person> persons;
};

/// How often views show the person together.
int LinksOf(const Person& person) {
  int links = 0;
  for (const int frame : person.FramesWith(2)) links += person.ViewsAt(frame) - 1;
  return links;
}

/// The people whom views show most often together.
std::vector<Person> MostSeen(std::vector<Person> persons, std::size_t count) {
  std::ranges::stable_sort(persons, [](const Person& a, const Person& b) { return LinksOf(a) > LinksOf(b); });
  if (persons.size() > count) persons.resize(count);
  return persons;
}

/// Wide lenses may not be found from the focal length of a normal lens, nor the other way round.
Solution BetterOfTwoLenses(const CaptureObservations& capture, CalibrationOptions options) {
  Solution normal = CalibrateStatic(capture, options);
  options.first_focal = kWideLens;
  Solution wide = CalibrateStatic(capture, options);
  return FitsBetter(capture, wide, normal) ? std::move(wide) : std::move(normal);
}

/// Calibrates the cameras from some people.
Candidate Calibrated(const PeopleObservations& people, const std::vector<Person>& persons, bool knows_depth_sign,
                     int frame_count, int iterations) {
  Candidate candidate;
  candidate.persons = MostSeen(persons, kCalibratingPeople);
  if (candidate.persons.empty()) return candidate;
  std::vector<std::vector<int>> frames;
  const auto share = static_cast<int>(frame_count / static_cast<int>(candidate.persons.size()));
  for (const Person& person : candidate.persons) frames.push_back(EvenlySpread(person.FramesWith(2), share));
  const CaptureObservations capture = AssembleCapture(people, candidate.persons, frames);
  if (static_cast<int>(FramesWithStart(capture).size()) < kMinFrames) return candidate;
  CalibrationOptions options;
  options.mirror = knows_depth_sign ? "keep" : "auto";
  options.frames = frame_count;
  options.max_iterations = iterations;
  const Solution solution = BetterOfTwoLenses(capture, options);
  if (!solution.calibration_summary.IsUsable()) return candidate;
  candidate.is_usable = true;
  candidate.known.cameras = solution.estimate.cameras;
  std::vector<double> sizes;
  for (const std::vector<double>& lengths : solution.estimate.log_bone_lengths) {
    double sum = 0.0;
    int bones = 0;
    for (const double length : lengths) {
      if (!std::isfinite(length)) continue;
      sum += std::exp(length);
      ++bones;
    }
    // A bone that is unknown of somebody must not make people smaller.
    if (bones > 0) sizes.push_back(sum / bones * (capture.joint_count() - 1));
  }
  if (!sizes.empty()) candidate.known.bones = Median(std::move(sizes));
  return candidate;
}

/// Follows everybody through some frames with the candidate's cameras.
void Rate(const PeopleObservations& people, std::span<const int> frames, Candidate& candidate) {
  FollowedPeople followed = FollowPeople(people, candidate.known, frames);
  candidate.score = followed.Score(people.lanes.view_count);
  candidate.persons = std::move(followed.persons);
}

/// Views that were placed wrongly, or not at all, are placed by the people whom the others show, if that explains more.
void PlaceViews(const PeopleObservations& people, std::span<const int> frames, Candidate& candidate) {
  for (int v = 0; v < people.lanes.view_count; ++v) {
    ThrowIfStopRequested();
    const std::optional<CameraEstimate> camera = PlaceView(people, candidate.known, candidate.persons, v);
    if (!camera) continue;
    Candidate placed = candidate;
    placed.known.cameras[static_cast<std::size_t>(v)] = *camera;
    Rate(people, frames, placed);
    if (placed.score > candidate.score + kClearGain) candidate = std::move(placed);
  }
}

/// Candidates from all proposals, the best.
Candidate BestCandidate(const PeopleObservations& people, std::span<const int> frames, const IdentityOptions& options) {
  const StartAgreement agreement(people);
  const std::vector<RotationProposal> proposals = agreement.Propose(kProposals);
  std::vector<Candidate> candidates(proposals.size());
  InParallel(static_cast<int>(proposals.size()), options.threads, [&](int i) {
    Candidate& candidate = candidates[static_cast<std::size_t>(i)];
    candidate = Calibrated(people, ConfidentPeople(people, agreement, proposals[static_cast<std::size_t>(i)]),
                           options.knows_depth_sign, kTrialFrames, kTrialIterations);
    if (candidate.is_usable) Rate(people, frames, candidate);
  });
  std::ranges::stable_sort(candidates, [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  if (candidates.size() > kImproved) candidates.resize(kImproved);
  InParallel(static_cast<int>(candidates.size()), options.threads, [&](int i) {
    Candidate& candidate = candidates[static_cast<std::size_t>(i)];
    if (candidate.is_usable) PlaceViews(people, frames, candidate);
  });
  const auto best = std::ranges::max_element(candidates, {}, &Candidate::score);
  return best == candidates.end() ? Candidate{} : std::move(*best);
}

/// Calibrates the cameras again from everybody who was found, as long as that explains no less.
void Improve(const PeopleObservations& people, std::span<const int> frames, const IdentityOptions& options,
             Candidate& candidate) {
  for (int round = 0; round < kFollowRounds; ++round) {
    ThrowIfStopRequested();
    Candidate better =
        Calibrated(people, candidate.persons, options.knows_depth_sign, kBetterFrames, kBetterIterations);
    if (better.is_usable) Rate(people, frames, better);
    if (better.is_usable && better.score >= candidate.score) candidate = std::move(better);
    PlaceViews(people, frames, candidate);
  }
}

FoundPerson Describe(const PeopleObservations& people, const CameraRays& rays, Person person) {
  FoundPerson found;
  found.frames = static_cast<int>(person.FramesWith(2).size());
  for (int v = 0; v < people.lanes.view_count; ++v) {
    int frames = 0;
    for (int t = 0; t < people.lanes.frame_count; ++t) frames += person.At(t, v) >= 0 ? 1 : 0;
    found.frames_of_view.push_back(frames);
  }
  found.error = 0.05 * MeanMisfit(people, rays, person);
  found.sure = ShareWithoutRival(people, rays, person);
  found.person = std::move(person);
  return found;
}

}  // namespace

FoundPeople FindPeople(const PeopleObservations& people, const IdentityOptions& options) {
  const std::vector<int> trial_frames = EvenRuns(ConsecutiveFrames(0, people.lanes.frame_count), kTrialRuns,
                                                 std::min(kTrialRunFrames, people.lanes.frame_count));
  Candidate best = BestCandidate(people, trial_frames, options);
  if (best.score < kLeastScore) {
    ThrowComputation(
        "{}: no two cameras show people in common: what they show fits together in no way, which is so where cameras "
        "filmed at different times, or the people of one are not those of another; import one person of each camera "
        "with `person` and look at which camera does not fit",
        people.capture.name);
  }
  Improve(people, trial_frames, options, best);
  FollowedPeople followed = FollowPeople(people, best.known, ConsecutiveFrames(0, people.lanes.frame_count));
  const CameraRays rays(people.capture, best.known.cameras);
  FoundPeople found;
  found.explained = followed.sightings > 0 ? static_cast<double>(followed.explained) / followed.sightings : 0.0;
  std::vector<Person> persons = JoinParts(people, rays, std::move(followed.persons));
  found.left_out = LeaveOutFalsePeople(people, rays, persons);
  for (Person& person : persons) found.people.push_back(Describe(people, rays, std::move(person)));
  const auto sightings = [](const FoundPerson& person) {
    return std::accumulate(person.frames_of_view.begin(), person.frames_of_view.end(), 0);
  };
  std::ranges::stable_sort(found.people,
                           [&](const FoundPerson& a, const FoundPerson& b) { return sightings(a) > sightings(b); });
  if (found.people.empty()) {
    ThrowComputation("{}: no two cameras show somebody in common for half a second or longer", people.capture.name);
  }
  return found;
}

}  // namespace canonpose
