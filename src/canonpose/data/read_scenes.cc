#include "canonpose/data/read_scenes.h"

#include "canonpose/data/dataset.h"
#include "canonpose/data/lifted_file.h"
#include "canonpose/data/solved_scene.h"

namespace canonpose {

std::vector<Scene> ReadScenes(const std::filesystem::path& path) {
  if (IsSceneFile(path)) return {ReadScene(path)};
  if (HasNameOfLiftedFile(path)) return {ReadLiftedScene(path)};
  const Dataset dataset = ReadDataset(path);
  std::vector<Scene> scenes;
  for (const Sequence& sequence : dataset.sequences) scenes.push_back(SceneOfSolved(dataset, sequence, path.string()));
  return scenes;
}

}  // namespace canonpose
