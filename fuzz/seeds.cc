// fuzz_seeds FOLDER: writes small datasets, scenes, models, checkpoints and NumPy arrays to folders of the targets'
// names.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <utility>

#include "canonpose/data/codecs/npy.h"
#include "canonpose/data/dataset.h"
#include "canonpose/model/model_file.h"
#include "canonpose/scene/scene.h"
#include "canonpose/train/checkpoint.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

const Skeleton kSkeleton{"", {"hips", "left", "right"}, {-1, 0, 0}, 0, {0, 2, 1}};
constexpr int kFrames = 2;

Camera MakeCamera() {
  Camera camera;
  camera.K << 100.0, 0.0, 32.0, 0.0, 100.0, 24.0, 0.0, 0.0, 1.0;
  camera.camera_from_world_translation = {0.0, 0.0, 3000.0};
  camera.distortion = {0.1, 0.0, 0.0, 0.0, 0.01};
  return camera;
}

PoseSequence MakePoses(const std::string& camera) {
  std::vector<float> positions;
  for (int i = 0; i < 3 * 3 * kFrames; ++i) positions.push_back(static_cast<float>(100 + 7 * i));
  return TruthPoses(kSkeleton, std::move(positions), camera);
}

Dataset MakeDataset(bool is_solved) {
  Sequence sequence;
  sequence.name = "walk";
  sequence.subject = "S1";
  sequence.capture = "studio";
  sequence.fps = 50.0;
  sequence.frame_count = kFrames;
  sequence.static_cameras = !is_solved;
  sequence.actions = {"walking", "standing"};
  sequence.action = {0, 1};
  for (const char* const name : {"a", "b"}) {
    CameraView view;
    view.name = name;
    view.image_size = {64, 48};
    view.keypoints = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    view.confidence = {1, 0.5, 0.25, 1, 1, 1};
    view.truth = MakePoses(name);
    view.calibration.assign(is_solved ? kFrames : 1, MakeCamera());
    if (is_solved) {
      view.solved = MakePoses(name);
      view.solved.standard_deviation().assign(3 * kFrames, 2.0F);
      view.solved_calibration = {MakeCamera()};
      view.time_offset_seconds = 0.1;
    }
    sequence.cameras.push_back(std::move(view));
  }
  return {kSkeleton, {"openpose", "body_25", 1.0, {"hips", "left", "right"}}, {std::move(sequence)}};
}

Scene MakeScene() {
  Scene scene;
  scene.name = "studio";
  scene.up.source = "the floor";
  PoseSequence person = MakePoses("");
  person.name = "1";
  person.coordinate_frame = {};
  person.fps = 50.0;
  person.time_seconds = {0.0, 0.02};
  scene.people = {person, person};
  scene.cameras = {{"a", {64, 48}, {MakeCamera()}, 0.0, true, ""}, {"b", {64, 48}, {}, 0.1, false, "sees nobody"}};
  return scene;
}

ModelFile MakeModel() {
  ModelFile model;
  model.info.program_version = "0.1.0";
  model.info.skeleton = kSkeleton;
  model.info.source = {"openpose", "body_25", 1.0, {"hips", "left", "right"}};
  model.info.width = 4;
  model.info.preset = "paper";
  model.info.options = "{}";
  model.info.data_files = {"data.h5"};
  model.info.data_fingerprints = {"0123456789abcdef"};
  model.parameters["weight"] = {{1, 2, 3, 4, 5, 6}, {2, 3}};
  model.parameters["bias"] = {{1, 2}, {2}};
  return model;
}

ModelFile MakeModelWithMorph() {
  ModelFile model = MakeModel();
  model.info.trap = {"right", 1.0, 60.0, 2.0};
  model.info.morph = std::make_shared<const ModelFile>(MakeModel());
  return model;
}

Checkpoint MakeCheckpoint() {
  Checkpoint checkpoint;
  checkpoint.info = MakeModel().info;
  checkpoint.parameters = checkpoint.first_moments = checkpoint.second_moments = MakeModel().parameters;
  return checkpoint;
}

Checkpoint MakeCheckpointWithRestarts() {
  Checkpoint checkpoint = MakeCheckpoint();
  checkpoint.restarts.running = 1;
  checkpoint.restarts.losses = {0.5};
  checkpoint.restarts.best = std::make_shared<const Checkpoint>(MakeCheckpoint());
  return checkpoint;
}

void WriteArray(const fs::path& path, const std::string& type, const std::vector<std::size_t>& shape,
                const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << npy::MakeHeader(type, shape) << bytes;
}

void WriteNumpyArrays(const fs::path& folder) {
  WriteArray(folder / "f4", "<f4", {2, 3}, std::string(24, '\x40'));
  WriteArray(folder / "f8", "<f8", {2}, std::string(16, '\x40'));
  WriteArray(folder / "i8", "<i8", {}, std::string(8, '\x01'));
  WriteArray(folder / "wide_text", "<U2", {2}, std::string("a\0\0\0b\0\0\0c\0\0\0\0\0\0\0", 16));
  WriteArray(folder / "text", "|S2", {2, 1}, "abcd");
  WriteArray(folder / "objects", "|O", {}, "\x80\x02}.");
}

void WriteSeeds(const fs::path& folder) {
  for (const char* const name : {"npy", "dataset", "scene", "model", "checkpoint"}) {
    fs::create_directories(folder / name);
  }
  WriteNumpyArrays(folder / "npy");
  WriteDataset(folder / "dataset" / "imported.h5", MakeDataset(false));
  WriteDataset(folder / "dataset" / "solved.h5", MakeDataset(true));
  WriteScene(folder / "scene" / "scene.h5", MakeScene());
  WriteModelFile(folder / "model" / "model.cpm", MakeModel());
  WriteModelFile(folder / "model" / "morph.cpm", MakeModelWithMorph());
  WriteCheckpoint(folder / "checkpoint" / "checkpoint.h5", MakeCheckpoint());
  WriteCheckpoint(folder / "checkpoint" / "restarts.h5", MakeCheckpointWithRestarts());
}

}  // namespace
}  // namespace canonpose

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: fuzz_seeds FOLDER\n", stderr);
    return 2;
  }
  try {
    canonpose::WriteSeeds(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
