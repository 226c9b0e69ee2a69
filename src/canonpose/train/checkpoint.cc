#include "canonpose/train/checkpoint.h"

#include <fmt/format.h>

namespace canonpose {
namespace {

constexpr const char* kFormat = "canonpose-checkpoint";
constexpr std::int64_t kVersion = 1;

void WriteGroup(h5::Group& root, const std::string& name, const NamedArrays& arrays) {
  h5::Group group = root.Create(name);
  WriteArrays(group, arrays);
}

}  // namespace

void WriteCheckpoint(const std::filesystem::path& path, const Checkpoint& checkpoint) {
  h5::File file = h5::File::CreateAt(path);
  h5::Group& root = file.root();
  root.SetString("format", kFormat);
  root.SetInt("version", kVersion);
  WriteModelInfo(root, checkpoint.info);
  root.SetDouble("sum_reprojection", checkpoint.sums.reprojection);
  root.SetDouble("sum_view", checkpoint.sums.view);
  root.SetDouble("sum_camera", checkpoint.sums.camera);
  root.SetDouble("sum_total", checkpoint.sums.total);
  root.SetInt("sum_steps", checkpoint.sums.steps);
  root.SetInt("perspective_steps", checkpoint.perspective_steps);
  WriteGroup(root, "parameters", checkpoint.parameters);
  WriteGroup(root, "first_moments", checkpoint.first_moments);
  WriteGroup(root, "second_moments", checkpoint.second_moments);
  file.Commit();
}

Checkpoint ReadCheckpoint(const std::filesystem::path& path) {
  h5::File file = h5::File::OpenForReading(path);
  const h5::Group& root = file.root();
  if (!root.HasAttribute("format") || root.GetString("format") != kFormat) {
    root.Fail("attribute format", fmt::format("\"{}\"", kFormat), "another file", "give the folder of a training run");
  }
  if (const std::int64_t version = root.GetInt("version"); version != kVersion) {
    root.Fail("attribute version", fmt::format("{}", kVersion), fmt::format("{}", version),
              "it was made by another version of this program: go on with that one or train again");
  }
  Checkpoint checkpoint;
  checkpoint.info = ReadModelInfo(root);
  checkpoint.sums = {root.GetDouble("sum_reprojection"), root.GetDouble("sum_view"), root.GetDouble("sum_camera"),
                     root.GetDouble("sum_total"), root.GetInt("sum_steps")};
  checkpoint.perspective_steps = root.GetInt("perspective_steps");
  checkpoint.parameters = ReadArrays(root.Open("parameters"));
  checkpoint.first_moments = ReadArrays(root.Open("first_moments"));
  checkpoint.second_moments = ReadArrays(root.Open("second_moments"));
  return checkpoint;
}

bool IsCheckpoint(const std::filesystem::path& path) {
  if (!h5::File::IsHdf5(path)) return false;
  h5::File file = h5::File::OpenForReading(path);
  return file.root().HasAttribute("format") && file.root().GetString("format") == kFormat;
}

}  // namespace canonpose
