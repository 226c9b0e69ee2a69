#include "canonpose/data/codecs/npz.h"
#include "canonpose/export/lift_output.h"

namespace canonpose {

void WriteLiftNpz(const std::filesystem::path& path, const LiftOutput& output) {
  const std::size_t frames = output.frames.size();
  const std::size_t joints = output.joints.size();
  NpzWriter writer(path);
  writer.Add("pose3d", output.pose3d, {frames, joints, 3});
  writer.Add("canonical", output.canonical, {frames, joints, 3});
  writer.Add("rotation", output.rotation, {frames, 3, 3});
  writer.AddStrings("joints", output.joints);
  writer.Add("frames", output.frames, {frames});
  writer.AddString("units", output.units);
  if (output.fps > 0.0) writer.Add("fps", std::vector<double>{output.fps}, {});
  writer.Commit();
}

}  // namespace canonpose
