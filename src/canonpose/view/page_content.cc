#include "canonpose/view/page_content.h"

#include <algorithm>
#include <utility>

#include "canonpose/base/error.h"
#include "canonpose/data/dataset.h"
#include "canonpose/data/read_scenes.h"

namespace canonpose {
namespace {

/// The keypoints of a sequence, for the cameras of its scene by name.
std::vector<ViewKeypoints> KeypointsOf(const Sequence& sequence, const Scene& scene) {
  std::vector<ViewKeypoints> detections(scene.cameras.size());
  for (std::size_t c = 0; c < scene.cameras.size(); ++c) {
    const auto view = std::ranges::find(sequence.cameras, scene.cameras[c].name, &CameraView::name);
    if (view != sequence.cameras.end()) detections[c] = {view->keypoints, view->confidence};
  }
  return detections;
}

}  // namespace

ShownResult ReadShownResult(const std::filesystem::path& path) {
  ShownResult result;
  result.name = path.filename().string();
  for (Scene& scene : ReadScenes(path)) {
    ShownScene& shown = result.scenes.emplace_back();
    shown.scene = std::move(scene);
    for (const PoseSequence& person : shown.scene.people) {
      shown.analyses.push_back(Analyse(person, shown.scene.up.is_known()));
    }
  }
  if (result.scenes.empty() ||
      std::ranges::all_of(result.scenes, [](const ShownScene& s) { return s.scene.people.empty(); })) {
    ThrowBadInput({path.string(), "", "somebody to show", "nobody", "solve a recording first"});
  }
  if (!IsDatasetFile(path)) return result;
  const Dataset dataset = ReadDataset(path);
  for (ShownScene& shown : result.scenes) {
    const auto sequence = std::ranges::find(dataset.sequences, shown.scene.name, &Sequence::name);
    if (sequence == dataset.sequences.end() || shown.scene.people.size() != 1) continue;
    shown.detections = {KeypointsOf(*sequence, shown.scene)};
    for (SceneCamera& camera : shown.scene.cameras) {
      const auto view = std::ranges::find(sequence->cameras, camera.name, &CameraView::name);
      if (view != sequence->cameras.end()) camera.time_offset_seconds = view->time_offset_seconds;
    }
  }
  return result;
}

}  // namespace canonpose
