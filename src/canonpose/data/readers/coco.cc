#include "canonpose/data/readers/coco.h"

#include "canonpose/data/codecs/json.h"
#include "canonpose/data/readers/flat_list.h"

namespace canonpose {

std::vector<CameraInput> FindCocoCameras(const std::filesystem::path& path) {
  return FindFileCameras(path, [](const std::filesystem::path&) { return false; });
}

DetectedCamera ReadCoco(const CameraInput& input) {
  const JsonValue root = JsonValue::Load(input.path);
  if (!root.json().is_array()) FailFormat(root, "a list of results");
  CameraBuilder builder(input);
  ReadFlatList(root, builder);
  return builder.Finish(true);
}

}  // namespace canonpose
