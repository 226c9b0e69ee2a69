#include <cmath>
#include <cstdint>
#include <vector>

#include "canonpose/data/codecs/npz.h"
#include "canonpose/export/lift_output.h"

namespace canonpose {

void WriteLiftNpz(const std::filesystem::path& path, const LiftedPoses& poses) {
  const std::size_t frames = poses.frames.size();
  const std::size_t joints = poses.skeleton().joints.size();
  NpzWriter writer(path);
  writer.Add("pose3d", poses.pose_in_camera.positions(), {frames, joints, 3});
  writer.Add("confidence", poses.pose_in_camera.confidence(), {frames, joints});
  writer.Add("standard_deviation", poses.pose_in_camera.standard_deviation(), {frames, joints});
  writer.Add("canonical", poses.canonical.positions(), {frames, joints, 3});
  writer.Add("rotation", poses.rotation, {frames, 3, 3});
  writer.AddStrings("joints", poses.skeleton().joints);
  const std::vector<std::int64_t> parents(poses.skeleton().parents.begin(), poses.skeleton().parents.end());
  writer.Add("parents", parents, {joints});
  writer.Add("frames", poses.frames, {frames});
  const double fps = poses.pose_in_camera.fps;
  std::vector<double> seconds;
  for (const std::int64_t frame : poses.frames) {
    seconds.push_back(fps > 0.0 ? static_cast<double>(frame) / fps : std::nan(""));
  }
  writer.Add("time", seconds, {frames});
  writer.AddString("units", UnitsInFile(poses));
  if (fps > 0.0) writer.Add("fps", std::vector<double>{fps}, {});
  writer.Commit();
}

}  // namespace canonpose
