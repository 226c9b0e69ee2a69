#include "canonpose/export/lift_output.h"

#include <string>

#include "canonpose/base/error.h"
#include "canonpose/scene/lifted_scene.h"

namespace canonpose {
namespace {

void WriteLiftScene(const std::filesystem::path& path, const LiftedPoses& poses) {
  WriteScene(path, SceneOfLifted(poses.pose_in_camera, poses.frames, path.stem().string()));
}

using WriteFunction = void (*)(const std::filesystem::path&, const LiftedPoses&);

WriteFunction WriterFor(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".npz") return WriteLiftNpz;
  if (extension == ".csv") return WriteLiftCsv;
  if (extension == ".json") return WriteLiftJson;
  if (extension == ".h5") return WriteLiftScene;
  ThrowInvalidArgument("{}: poses can be written as .npz, .csv, .json or .h5", path.string());
}

}  // namespace

void RequireLiftFormat(const std::filesystem::path& path) { WriterFor(path); }

std::string UnitsInFile(const LiftedPoses& poses) {
  const LengthUnit unit = poses.pose_in_camera.unit;
  return unit == LengthUnit::kEachItsOwn ? "network units" : ToString(unit);
}

void WriteLiftOutput(const std::filesystem::path& path, const LiftedPoses& poses) {
  const std::size_t frames = poses.frames.size();
  const std::size_t values = frames * poses.skeleton().joints.size() * 3;
  CANONPOSE_CHECK(poses.pose_in_camera.positions().size() == values && poses.canonical.positions().size() == values,
                  "{} and {} values, not {}", poses.pose_in_camera.positions().size(),
                  poses.canonical.positions().size(), values);
  CANONPOSE_CHECK(poses.rotation.size() == 9 * frames, "{} values for {} rotations", poses.rotation.size(), frames);
  CANONPOSE_CHECK(poses.canonical.unit == poses.pose_in_camera.unit, "{} and {}", ToString(poses.canonical.unit),
                  ToString(poses.pose_in_camera.unit));
  WriterFor(path)(path, poses);
}

}  // namespace canonpose
