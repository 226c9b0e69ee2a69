#include "canonpose/view/page_content.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

#include "canonpose/base/error.h"
#include "canonpose/data/dataset.h"
#include "canonpose/data/read_scenes.h"
#include "canonpose/data/solved_scene.h"

namespace canonpose {
namespace {

/// What a view saw, frame by frame of the sequence.
ViewKeypoints KeypointsOf(const Sequence& sequence, const CameraView& view) {
  const std::size_t joints = view.confidence.size() / static_cast<std::size_t>(std::max(1, sequence.frame_count));
  const ViewClock clock(sequence, view);
  ViewKeypoints shown{std::vector<float>(view.keypoints.size(), std::numeric_limits<float>::quiet_NaN()),
                      std::vector<float>(view.confidence.size(), 0.0F)};
  for (int n = 0; n < sequence.frame_count; ++n) {
    const int own = clock.OwnFrame(n);
    if (own < 0) continue;
    const std::size_t from = static_cast<std::size_t>(own) * joints;
    const std::size_t to = static_cast<std::size_t>(n) * joints;
    std::copy_n(&view.keypoints[2 * from], 2 * joints, &shown.keypoints[2 * to]);
    std::copy_n(&view.confidence[from], joints, &shown.confidence[to]);
  }
  return shown;
}

/// The keypoints of a sequence, for the cameras of its scene by name.
std::vector<ViewKeypoints> KeypointsOf(const Sequence& sequence, const Scene& scene) {
  std::vector<ViewKeypoints> detections(scene.cameras.size());
  for (std::size_t c = 0; c < scene.cameras.size(); ++c) {
    const auto view = std::ranges::find(sequence.cameras, scene.cameras[c].name, &CameraView::name);
    if (view != sequence.cameras.end()) detections[c] = KeypointsOf(sequence, *view);
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
    const std::vector<const Sequence*> sequences = SequencesOf(dataset, shown.scene);
    if (sequences.empty()) continue;
    shown.capture = sequences.front()->capture;
    if (shown.scene.people.size() != sequences.size()) continue;
    shown.detections.clear();
    for (const Sequence* sequence : sequences) shown.detections.push_back(KeypointsOf(*sequence, shown.scene));
    // What the cameras saw now stands at the scene's frames.
    for (SceneCamera& camera : shown.scene.cameras) camera.time_offset_seconds = 0.0;
  }
  return result;
}

}  // namespace canonpose
