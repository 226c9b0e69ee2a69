#include "canonpose/data/readers/coco.h"

#include "canonpose/data/codecs/json.h"
#include "canonpose/data/readers/flat_list.h"

namespace canonpose {

std::vector<CameraInput> FindCocoCameras(const std::filesystem::path& path) {
  return FindFileCameras(path, [](const std::filesystem::path&) { return false; });
}

DetectedCamera ReadCoco(const CameraInput& input) {
  const JsonValue root = JsonValue::Load(input.path);
  if (root.Has("annotations")) {
    root.Fail("a list of results", "this is an annotation file; its third value is a visibility, not a confidence");
  }
  if (!root.json().is_array()) root.Fail("a list of results", AdviseFormat(root));
  CameraBuilder builder(input);
  ReadFlatList(root, builder);
  return builder.Finish(true);
}

}  // namespace canonpose
