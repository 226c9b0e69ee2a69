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

void WriteState(h5::Group& group, const Checkpoint& checkpoint) {
  WriteModelInfo(group, checkpoint.info);
  group.SetDouble("sum_reprojection", checkpoint.sums.reprojection);
  group.SetDouble("sum_view", checkpoint.sums.view);
  group.SetDouble("sum_camera", checkpoint.sums.camera);
  group.SetDouble("sum_total", checkpoint.sums.total);
  group.SetInt("sum_steps", checkpoint.sums.steps);
  group.SetInt("perspective_steps", checkpoint.perspective_steps);
  WriteGroup(group, "parameters", checkpoint.parameters);
  WriteGroup(group, "first_moments", checkpoint.first_moments);
  WriteGroup(group, "second_moments", checkpoint.second_moments);
  group.SetInt("restart", checkpoint.restarts.running);
  const std::vector<double>& losses = checkpoint.restarts.losses;
  if (!losses.empty()) group.Write<double>("restart_losses", losses, {losses.size()});
  if (checkpoint.restarts.best) {
    h5::Group best = group.Create("best_restart");
    WriteState(best, *checkpoint.restarts.best);
  }
}

Checkpoint ReadState(const h5::Group& group) {
  Checkpoint checkpoint;
  checkpoint.info = ReadModelInfo(group);
  checkpoint.sums = {group.GetDouble("sum_reprojection"), group.GetDouble("sum_view"), group.GetDouble("sum_camera"),
                     group.GetDouble("sum_total"), group.GetInt("sum_steps")};
  checkpoint.perspective_steps = group.GetInt("perspective_steps");
  checkpoint.parameters = ReadArrays(group.Open("parameters"));
  checkpoint.first_moments = ReadArrays(group.Open("first_moments"));
  checkpoint.second_moments = ReadArrays(group.Open("second_moments"));
  // Checkpoints of earlier versions have no restarts.
  if (group.HasAttribute("restart")) checkpoint.restarts.running = static_cast<int>(group.GetInt("restart"));
  if (group.Has("restart_losses")) checkpoint.restarts.losses = group.Read<double>("restart_losses").values;
  if (group.Has("best_restart")) {
    // In a damaged file a group may hold itself.
    if (group.path().ends_with("/best_restart")) {
      group.Fail("best_restart", "no further one in the best restart", "one", "the file is damaged: train again");
    }
    checkpoint.restarts.best = std::make_shared<const Checkpoint>(ReadState(group.Open("best_restart")));
  }
  return checkpoint;
}

}  // namespace

EpochSums EpochSums::Mean() const {
  const auto count = static_cast<double>(steps > 0 ? steps : 1);
  return {reprojection / count, view / count, camera / count, total / count, steps};
}

ModelFile ModelOf(const Checkpoint& checkpoint) {
  ModelFile model{checkpoint.info, checkpoint.parameters};
  model.parameters.erase(kPerspectiveParameter);
  return model;
}

void WriteCheckpoint(const std::filesystem::path& path, const Checkpoint& checkpoint) {
  h5::File file = h5::File::CreateAt(path);
  h5::Group& root = file.root();
  root.SetString("format", kFormat);
  root.SetInt("version", kVersion);
  WriteState(root, checkpoint);
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
              "it was made by another version of this program: resume with that one or train again");
  }
  return ReadState(root);
}

bool IsCheckpoint(const std::filesystem::path& path) {
  if (!h5::File::IsHdf5(path)) return false;
  h5::File file = h5::File::OpenForReading(path);
  return file.root().HasAttribute("format") && file.root().GetString("format") == kFormat;
}

}  // namespace canonpose
