#include "canonpose/export/lift_output.h"

#include <string>

#include "canonpose/base/error.h"

namespace canonpose {
namespace {

using WriteFunction = void (*)(const std::filesystem::path&, const LiftOutput&);

WriteFunction WriterFor(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".npz") return WriteLiftNpz;
  if (extension == ".csv") return WriteLiftCsv;
  if (extension == ".json") return WriteLiftJson;
  ThrowInvalidArgument("{}: poses can be written as .npz, .csv or .json", path.string());
}

}  // namespace

void RequireLiftFormat(const std::filesystem::path& path) { WriterFor(path); }

void WriteLiftOutput(const std::filesystem::path& path, const LiftOutput& output) {
  const std::size_t frames = output.frames.size();
  const std::size_t values = frames * output.joints.size() * 3;
  CANONPOSE_CHECK(output.pose3d.size() == values && output.canonical.size() == values, "{} and {} values, not {}",
                  output.pose3d.size(), output.canonical.size(), values);
  CANONPOSE_CHECK(output.rotation.size() == 9 * frames, "{} values for {} rotations", output.rotation.size(), frames);
  WriterFor(path)(path, output);
}

}  // namespace canonpose
