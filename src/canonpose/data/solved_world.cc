#include "canonpose/data/solved_world.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/data/solved_scene.h"

namespace canonpose {
namespace {

bool HasSolution(const Sequence& sequence) {
  return std::ranges::any_of(sequence.cameras, [](const CameraView& view) {
    return !view.solved_calibration.empty() && view.solved.AnyKnown();
  });
}

void MoveToWorld(const WorldPlacement& world, const Sequence& sequence, CameraView& view) {
  const auto factor = static_cast<float>(world.scale);
  if (world.scale != 1.0) {
    for (float& coordinate : view.solved.positions()) coordinate *= factor;
    for (float& deviation : view.solved.standard_deviation()) deviation *= factor;
  }
  if (!view.solved.empty()) view.solved.unit = world.unit;
  // Where cameras move, every frame of the sequence has a placement of its own.
  std::vector<int> frames(view.solved_calibration.size());
  std::iota(frames.begin(), frames.end(), 0);
  if (frames.size() > 1) {
    const ViewClock clock(sequence, view);
    for (int n = 0; n < sequence.frame_count; ++n) {
      if (const int own = clock.OwnFrame(n); own >= 0) frames[static_cast<std::size_t>(own)] = n;
    }
  }
  for (std::size_t t = 0; t < frames.size(); ++t) {
    view.solved_calibration[t] = world.Apply(frames[t], view.solved_calibration[t]);
  }
}

Eigen::Vector3d CentreOf(const Camera& camera) {
  return -camera.camera_from_world_rotation.transpose() * camera.camera_from_world_translation;
}

/// Throws where the dataset lacks one of the cameras, or they move.
void RequireCameras(const Dataset& dataset, const KnownDistance& distance) {
  std::set<std::string> names;
  for (const Sequence& sequence : dataset.sequences) {
    if (!sequence.static_cameras) {
      ThrowInvalidArgument("`camera_distance`: expected cameras that stand still, but those of {} move; give a height",
                           sequence.name);
    }
    for (const CameraView& view : sequence.cameras) names.insert(view.name);
  }
  for (const std::string& name : {distance.camera, distance.other}) {
    if (names.contains(name)) continue;
    ThrowInvalidArgument("`camera_distance`: expected cameras of the data ({}), found {}", fmt::join(names, ", "),
                         name);
  }
}

}  // namespace

void PlaceSolvedInWorld(std::span<const std::size_t> sequences, const WorldMeasures& measures, Dataset& dataset) {
  std::vector<Scene> scenes;
  std::vector<Sequence*> placed;
  for (const std::size_t index : sequences) {
    Sequence& sequence = dataset.sequences[index];
    if (!HasSolution(sequence)) continue;
    scenes.push_back(SceneOfSolved(dataset, sequence, ""));
    placed.push_back(&sequence);
  }
  if (scenes.empty()) return;
  const WorldPlacement world = FindWorld(scenes, measures);
  for (Sequence* sequence : placed) {
    for (CameraView& view : sequence->cameras) MoveToWorld(world, *sequence, view);
    sequence->solved_world = world.known;
  }
}

WorldMeasures DistancesOfCalibration(const Sequence& sequence) {
  WorldMeasures measures;
  measures.distances_source = "the distances between the cameras in the calibration";
  const std::vector<CameraView>& views = sequence.cameras;
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const bool are_known = views[i].calibration.size() == 1 && views[j].calibration.size() == 1 &&
                             views[i].solved_calibration.size() == 1 && views[j].solved_calibration.size() == 1;
      if (!are_known) continue;
      const double distance = (CentreOf(views[i].calibration.front()) - CentreOf(views[j].calibration.front())).norm();
      if (distance > 0.0) measures.distances.push_back({views[j].name, views[i].name, distance});
    }
  }
  return measures;
}

WorldMeasures MeasuresIn(const Sequence& sequence, const WorldMeasures& measures) {
  const auto is_solved = [&](const std::string& name) {
    return std::ranges::any_of(sequence.cameras, [&](const CameraView& view) {
      return view.name == name && view.solved.AnyKnown() && !view.solved_calibration.empty();
    });
  };
  WorldMeasures here = measures;
  std::erase_if(here.distances,
                [&](const KnownDistance& known) { return !is_solved(known.camera) || !is_solved(known.other); });
  return here;
}

void RequireMeasuresOf(const Dataset& dataset, const WorldMeasures& measures) {
  for (const KnownDistance& distance : measures.distances) RequireCameras(dataset, distance);
  const std::vector<KnownHeight>& heights = measures.heights;
  std::set<std::string> people;
  for (const Sequence& sequence : dataset.sequences) people.insert(sequence.subject);
  std::set<std::string> given;
  for (const KnownHeight& height : heights) {
    if (!given.insert(height.person).second) {
      ThrowInvalidArgument("`height`: found two heights of {}; give one",
                           height.person.empty() ? "everybody" : height.person);
    }
    if (height.person.empty() && (people.size() > 1 || heights.size() > 1)) {
      ThrowInvalidArgument("`height`: expected whose height it is, as in {}={:g}, because the data show {}",
                           people.empty() ? "" : *people.rbegin(), height.height_mm / 1000.0, fmt::join(people, ", "));
    }
    if (!height.person.empty() && !people.contains(height.person)) {
      ThrowInvalidArgument("`height`: expected a person whom the data show ({}), found {}", fmt::join(people, ", "),
                           height.person);
    }
  }
}

}  // namespace canonpose
