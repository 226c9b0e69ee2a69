#include "canonpose/data/read_scenes.h"

#include "canonpose/data/dataset.h"
#include "canonpose/data/lifted_file.h"
#include "canonpose/data/solved_scene.h"

namespace canonpose {

std::vector<Scene> ReadScenes(const std::filesystem::path& path) {
  if (IsSceneFile(path)) return {ReadScene(path)};
  if (HasNameOfLiftedFile(path)) return {ReadLiftedScene(path)};
  return ScenesOfSolved(ReadDataset(path), path.string());
}

}  // namespace canonpose
