// A scene, HDF5.
#include "canonpose/scene/scene.h"

#include "fuzzing.h"

CANONPOSE_FUZZ_TARGET(bytes) {
  const std::filesystem::path path = canonpose::fuzz::Write("scene.h5", bytes);
  if (canonpose::IsSceneFile(path)) canonpose::ReadScene(path);
}
