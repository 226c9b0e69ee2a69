// The dataset file: groups, attributes and arrays as docs/dataset.md describes them.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/hdf5.h"
#include "canonpose/base/names.h"
#include "canonpose/data/codecs/file_kind.h"
#include "canonpose/data/dataset.h"
#include "canonpose/data/dataset_values.h"
#include "canonpose/data/track_arrays.h"
#include "canonpose/scene/camera_file.h"
#include "canonpose/scene/provenance_file.h"
#include "canonpose/scene/skeleton_file.h"

namespace canonpose {
namespace {

constexpr const char* kFormat = "canonpose-dataset";
constexpr std::int64_t kVersion = 1;
/// Of files with tracks of several people.
constexpr std::int64_t kVersionWithTracks = 2;

// --------------------------------------------------------------------------------------------------------- reading

/// What there is of uncertainties and confidences of solved joints.
void ReadSolvedDetails(const h5::Group& group, const DatasetPlace& place, PoseSequence& solved) {
  const auto joints = static_cast<std::size_t>(solved.joint_count());
  const std::vector<std::size_t> shape = {static_cast<std::size_t>(solved.frame_count()), joints};
  if (group.Has("solved_uncertainty")) {
    solved.standard_deviation() = ReadArray(group, "solved_uncertainty", shape, "frames, joints");
  }
  if (!group.Has("solved_confidence")) return;
  const std::vector<float> confidence = ReadArray(group, "solved_confidence", shape, "frames, joints");
  for (std::size_t i = 0; i < confidence.size(); ++i) {
    if (!(confidence[i] >= 0.0F && confidence[i] <= 1.0F)) {
      place.Fail("solved_confidence", i / joints, i % joints, "a number from 0 to 1", confidence[i],
                 "write 1 where nothing is known against a solved joint");
    }
    if (solved.confidence()[i] > 0.0F) solved.confidence()[i] = confidence[i];  // a missing joint keeps its 0
  }
}

/// The number of frames of an array of keypoints, checked against that of the previous cameras, -1 for the first.
int CountFrames(const h5::Group& group, const Skeleton& skeleton, int previous) {
  const std::vector<std::size_t> shape = group.Shape("keypoints");
  const std::size_t joints = skeleton.joints.size();
  if (shape.size() != 3 || shape[0] == 0 || shape[0] > INT32_MAX || shape[1] != joints || shape[2] != 2) {
    group.Fail("keypoints", fmt::format("shape (T, {}, 2) = frames, joints of /skeleton, x and y", joints),
               h5::FormatShape(shape), "");
  }
  const auto frames = static_cast<int>(shape[0]);
  if (previous >= 0 && frames != previous) {
    group.Fail("keypoints", fmt::format("{} frames as in the previous cameras", previous), fmt::format("{}", frames),
               "cameras of a sequence are synchronised: give all the same frames, with NaN where a camera saw nothing");
  }
  return frames;
}

/// frame_count is that of the previous cameras, -1 for the first.
CameraView ReadCamera(const h5::Group& group, const std::string& name, const Skeleton& skeleton, LengthUnit solved_unit,
                      int* frame_count) {
  CameraView view;
  view.name = name;
  const std::vector<std::int64_t> size = group.GetInts("image_size");
  if (size.size() != 2 || size[0] <= 0 || size[1] <= 0 || size[0] > INT32_MAX || size[1] > INT32_MAX) {
    group.Fail("attribute image_size", "width and height in pixels, both positive",
               size.size() == 2 ? fmt::format("{} and {}", size[0], size[1]) : fmt::format("{} numbers", size.size()),
               "");
  }
  view.image_size = {static_cast<int>(size[0]), static_cast<int>(size[1])};
  if (group.HasAttribute("time_offset_seconds")) view.time_offset_seconds = group.GetDouble("time_offset_seconds");

  const std::size_t joints = skeleton.joints.size();
  const DatasetPlace place{group.file(), group.path(), &skeleton};
  if (group.Has("tracks")) {
    ReadTracks(group, skeleton, *frame_count, view);
  } else {
    *frame_count = CountFrames(group, skeleton, *frame_count);
    const auto count = static_cast<std::size_t>(*frame_count);
    view.keypoints = ReadArray(group, "keypoints", {count, joints, 2}, "");
    view.confidence = ReadArray(group, "confidence", {count, joints}, "frames, joints");
    CheckKeypoints(place, view.keypoints, view.confidence);
  }
  const int frames = *frame_count;
  const auto count = static_cast<std::size_t>(frames);
  const std::vector<std::size_t> pose_shape = {count, joints, 3};
  const auto read_poses = [&](const std::string& array, LengthUnit unit) -> PoseSequence {
    if (!group.Has(array)) return {};
    std::vector<float> positions = ReadArray(group, array, pose_shape, "frames, joints, x y z");
    CheckPoses(positions, array, place);
    return PosesInCamera(skeleton, std::move(positions), unit, name);
  };
  view.truth = read_poses("truth", LengthUnit::kMillimetres);
  view.solved = read_poses("solved", solved_unit);
  if (!view.solved.empty()) ReadSolvedDetails(group, place, view.solved);
  if (group.Has("solved_frames")) {
    const h5::Array<double> solved_frames = group.Read<double>("solved_frames");
    if (solved_frames.shape != std::vector<std::size_t>{count}) {
      group.Fail("solved_frames", fmt::format("shape ({}) = frames", frames), h5::FormatShape(solved_frames.shape), "");
    }
    view.solved_frames = solved_frames.values;
  }
  view.calibration = ReadCameras(group, frames);
  view.solved_calibration = ReadCameras(group, frames, "solved_");
  return view;
}

std::string DefaultCapture(const Sequence& sequence) {
  return sequence.static_cameras && !sequence.subject.empty() ? sequence.subject : sequence.name;
}

/// Of solved poses; files from before they could be in millimetres do not say.
LengthUnit ReadSolvedUnit(const h5::Group& group) {
  if (!group.HasAttribute("solved_unit")) return LengthUnit::kBodyLengths;
  const std::string unit = group.GetString("solved_unit");
  for (const LengthUnit known : {LengthUnit::kMillimetres, LengthUnit::kBodyLengths}) {
    if (unit == ToString(known)) return known;
  }
  group.Fail("attribute solved_unit",
             fmt::format("\"{}\" or \"{}\"", ToString(LengthUnit::kMillimetres), ToString(LengthUnit::kBodyLengths)),
             '"' + unit + '"', "");
}

/// Writes the unit of solved poses and what is known of their world, where there are any.
void WriteSolvedWorld(h5::Group& group, const Sequence& sequence) {
  const auto solved =
      std::ranges::find_if(sequence.cameras, [](const CameraView& view) { return !view.solved.empty(); });
  if (solved == sequence.cameras.end()) return;
  const LengthUnit unit = solved->solved.unit;
  for (const CameraView& view : sequence.cameras) {
    CANONPOSE_CHECK(view.solved.empty() || view.solved.unit == unit, "{} and {}", ToString(view.solved.unit),
                    ToString(unit));
  }
  if (unit == LengthUnit::kMillimetres) group.SetString("solved_unit", ToString(unit));
  WriteWorldProvenance(group, sequence.solved_world, "solved_");
}

void ReadActions(const h5::Group& group, Sequence& sequence) {
  if (group.HasAttribute("actions")) sequence.actions = group.GetStrings("actions");
  if (!group.Has("action")) return;
  const auto frames = static_cast<std::size_t>(sequence.frame_count);
  if (group.Shape("action") != std::vector{frames}) {
    group.Fail("action", fmt::format("shape ({}) = frames", frames), h5::FormatShape(group.Shape("action")), "");
  }
  for (const std::int64_t action : group.Read<std::int64_t>("action").values) {
    if (action < 0 || action >= std::ssize(sequence.actions)) {
      group.Fail("action", fmt::format("indices into the attribute actions, which has {}", sequence.actions.size()),
                 fmt::format("{}", action), "");
    }
    sequence.action.push_back(static_cast<std::uint8_t>(action));
  }
}

/// Of a sequence with tracks: a camera that saw nobody does not show how many frames there are.
int ReadFrameCount(const h5::Group& group) {
  const std::int64_t frames = group.GetInt("frames");
  if (frames < 1 || frames > INT32_MAX) {
    group.Fail("attribute frames", "the number of frames", fmt::format("{}", frames), "");
  }
  return static_cast<int>(frames);
}

constexpr std::array<std::pair<FrameTiming, const char*>, 3> kTimings = {
    {{FrameTiming::kCommon, "yes"}, {FrameTiming::kUnsure, "unsure"}, {FrameTiming::kOwn, "no"}}};

/// Files from before cameras could be unsynchronised do not say.
FrameTiming ReadTiming(const h5::Group& group) {
  if (!group.HasAttribute("synchronised")) return FrameTiming::kCommon;
  const std::string found = group.GetString("synchronised");
  for (const auto& [timing, name] : kTimings) {
    if (found == name) return timing;
  }
  group.Fail("attribute synchronised", "\"yes\", \"no\" or \"unsure\"", '"' + found + '"', "");
}

void WriteTiming(h5::Group& group, FrameTiming timing) {
  for (const auto& [known, name] : kTimings) {
    if (known == timing && timing != FrameTiming::kCommon) group.SetString("synchronised", name);
  }
}

Sequence ReadSequence(const h5::Group& group, const std::string& name, const Skeleton& skeleton) {
  Sequence sequence;
  sequence.name = name;
  sequence.subject = group.GetString("subject");
  if (group.HasAttribute("fps")) sequence.fps = group.GetDouble("fps");
  if (!std::isfinite(sequence.fps) || sequence.fps < 0.0) {
    group.Fail("attribute fps", "frames per second, 0 where unknown", fmt::format("{}", sequence.fps), "");
  }
  const std::int64_t is_static = group.GetInt("static_cameras");
  if (is_static != 0 && is_static != 1) {
    group.Fail("attribute static_cameras", "1 where the cameras are static, otherwise 0", fmt::format("{}", is_static),
               "");
  }
  sequence.static_cameras = is_static == 1;
  sequence.timing = ReadTiming(group);
  if (group.HasAttribute("capture")) sequence.capture = group.GetString("capture");
  sequence.capture_is_named = !sequence.capture.empty();
  if (!sequence.capture_is_named) sequence.capture = DefaultCapture(sequence);

  const LengthUnit solved_unit = ReadSolvedUnit(group);
  sequence.solved_world = ReadWorldProvenance(group, "solved_");
  const h5::Group cameras = group.Open("cameras");
  int frame_count = group.HasAttribute("frames") ? ReadFrameCount(group) : -1;
  for (const std::string& camera : cameras.Children()) {
    sequence.cameras.push_back(ReadCamera(cameras.Open(camera), camera, skeleton, solved_unit, &frame_count));
  }
  if (sequence.cameras.empty()) group.Fail("cameras", "at least one camera", "none", "");
  sequence.frame_count = frame_count;
  ReadActions(group, sequence);
  if (group.HasAttribute("truth_kind")) sequence.truth_kind = group.GetString("truth_kind");
  if (group.HasAttribute("scene")) sequence.scene = group.GetString("scene");
  return sequence;
}

void CheckFormat(const h5::Group& root) {
  const std::string advice = "make a dataset with `canonpose import`, or write one as docs/dataset.md describes";
  if (!root.HasAttribute("format")) {
    root.Fail("attribute format", fmt::format("\"{}\"", kFormat), "nothing", advice);
  }
  const std::string format = root.GetString("format");
  if (format != kFormat) root.Fail("attribute format", fmt::format("\"{}\"", kFormat), '"' + format + '"', advice);
  const std::int64_t version = root.GetInt("version");
  if (version != kVersion && version != kVersionWithTracks) {
    root.Fail("attribute version", fmt::format("{} or {}", kVersion, kVersionWithTracks), fmt::format("{}", version),
              version > kVersionWithTracks
                  ? "the file is from a newer version of canonpose: update this one, or create the file again with it"
                  : "create the file again");
  }
}

DatasetSource ReadSource(const h5::Group& root, const h5::Group& skeleton_group, const Skeleton& skeleton) {
  DatasetSource source;
  if (root.HasAttribute("source_format")) source.format = root.GetString("source_format");
  if (root.HasAttribute("source_layout")) source.layout = root.GetString("source_layout");
  if (root.HasAttribute("source_morph")) source.morph = root.GetString("source_morph");
  if (root.HasAttribute("confidence_scale")) source.confidence_scale = root.GetDouble("confidence_scale");
  if (!(source.confidence_scale > 0.0) || !std::isfinite(source.confidence_scale)) {
    root.Fail("attribute confidence_scale", "a positive number", fmt::format("{}", source.confidence_scale), "");
  }
  if (skeleton_group.HasAttribute("mapping")) {
    source.mapping = skeleton_group.GetStrings("mapping");
    if (source.mapping.size() != skeleton.joints.size()) {
      skeleton_group.Fail("attribute mapping", fmt::format("{} strings, one per joint", skeleton.joints.size()),
                          fmt::format("{}", source.mapping.size()), "");
    }
  }
  return source;
}

// --------------------------------------------------------------------------------------------------------- writing

template <typename T>
void Write(h5::Group& group, const std::string& name, const std::vector<T>& values,
           const std::vector<std::size_t>& shape) {
  group.Write<T>(name, std::span<const T>(values), shape);
}

/// Writes uncertainties, and confidences where they say more than which joints are known.
void WriteSolvedDetails(h5::Group& camera, const PoseSequence& solved) {
  const std::vector<std::size_t> shape = {static_cast<std::size_t>(solved.frame_count()),
                                          static_cast<std::size_t>(solved.joint_count())};
  if (!LacksUncertainty(solved)) Write(camera, "solved_uncertainty", solved.standard_deviation(), shape);
  PoseSequence trusted = solved;
  trusted.TrustKnownJoints();
  std::vector<float> confidence = solved.confidence();
  // What is written for a missing joint is 0, whatever its confidence was.
  for (std::size_t i = 0; i < confidence.size(); ++i) {
    if (trusted.confidence()[i] == 0.0F) confidence[i] = 0.0F;
  }
  if (confidence != trusted.confidence()) Write(camera, "solved_confidence", confidence, shape);
}

/// Names become names of groups in the file, so some cannot be used.
void CheckName(const std::filesystem::path& path, const std::string& name, const std::string& what) {
  if (name.empty() || name == "." || name == ".." || name.find('/') != std::string::npos) {
    ThrowBadInput(
        {path.string(), "", fmt::format("a name for the {} without '/'", what), '"' + name + '"', "rename it"});
  }
}

}  // namespace

Dataset ReadDataset(const std::filesystem::path& path, TracksInDataset tracks) {
  if (KindOfFile(path) == "a video") {
    ThrowBadInput({path.string(), "", "a dataset", "a video",
                   "run a 2D keypoint detector on it, import what the detector writes, and give that dataset"});
  }
  h5::File file = h5::File::OpenForReading(path);
  const h5::Group& root = file.root();
  CheckFormat(root);
  Dataset dataset;
  const h5::Group skeleton_group = root.Open("skeleton");
  dataset.skeleton = ReadSkeleton(skeleton_group);
  dataset.source = ReadSource(root, skeleton_group, dataset.skeleton);
  const h5::Group sequences = root.Open("sequences");
  for (const std::string& name : sequences.Children()) {
    dataset.sequences.push_back(ReadSequence(sequences.Open(name), name, dataset.skeleton));
    if (tracks == TracksInDataset::kAllowed || !dataset.sequences.back().HasTracks()) continue;
    sequences.Fail(name, "keypoints of one person", "tracks of several people, not yet told apart",
                   "run `canonpose solve` first, which finds who is who across the cameras");
  }
  if (dataset.sequences.empty()) root.Fail("sequences", "at least one sequence", "none", "");
  return dataset;
}

bool IsDatasetFile(const std::filesystem::path& path) {
  if (!h5::File::IsHdf5(path)) return false;
  h5::File file = h5::File::OpenForReading(path);
  if (!file.root().HasAttribute("format")) return false;
  try {
    return file.root().GetString("format") == kFormat;
  } catch (const Error&) {
    return false;  // an attribute of that name which is not text belongs to another format
  }
}

void RequireDatasetName(const std::filesystem::path& path) {
  const std::string extension = LowerCase(path.extension().string());
  if (extension.empty() || extension == ".h5" || extension == ".hdf5") return;
  ThrowInvalidArgument("{}: a dataset is an HDF5 file; name it {}", path.string(),
                       std::filesystem::path(path).replace_extension(".h5").filename().string());
}

struct DatasetWriter::State {
  std::filesystem::path path;
  Skeleton skeleton;
  TracksInDataset tracks;
  h5::File file;
  h5::Group sequences;
};

DatasetWriter::DatasetWriter(const std::filesystem::path& path, const Skeleton& skeleton, const DatasetSource& source,
                             TracksInDataset tracks) {
  CANONPOSE_CHECK(skeleton.Problem().empty(), "{}", skeleton.Problem());
  CANONPOSE_CHECK(source.mapping.empty() || source.mapping.size() == skeleton.joints.size(),
                  "{} mappings for {} joints", source.mapping.size(), skeleton.joints.size());
  h5::File file = h5::File::CreateAt(path);
  file.root().SetString("format", kFormat);
  file.root().SetInt("version", tracks == TracksInDataset::kAllowed ? kVersionWithTracks : kVersion);
  if (!source.format.empty()) file.root().SetString("source_format", source.format);
  if (!source.layout.empty()) file.root().SetString("source_layout", source.layout);
  if (!source.morph.empty()) file.root().SetString("source_morph", source.morph);
  file.root().SetDouble("confidence_scale", source.confidence_scale);
  h5::Group skeleton_group = file.root().Create("skeleton");
  WriteSkeleton(skeleton_group, skeleton);
  if (!source.mapping.empty()) skeleton_group.SetStrings("mapping", source.mapping);
  h5::Group sequences = file.root().Create("sequences");
  state_ = std::make_unique<State>(State{path, skeleton, tracks, std::move(file), std::move(sequences)});
}

DatasetWriter::~DatasetWriter() = default;

void DatasetWriter::Add(const Sequence& sequence) {
  CANONPOSE_CHECK(state_ != nullptr, "the file has already been committed");
  CheckName(state_->path, sequence.name, "sequence");
  if (state_->sequences.Has(sequence.name)) {
    ThrowBadInput({state_->path.string(), "", "sequences of different names",
                   fmt::format("two called {}", sequence.name), "rename one"});
  }
  h5::Group group = state_->sequences.Create(sequence.name);
  group.SetString("subject", sequence.subject);
  group.SetDouble("fps", sequence.fps);
  group.SetInt("static_cameras", sequence.static_cameras ? 1 : 0);
  WriteTiming(group, sequence.timing);
  // A default that was written would be read as a name, which other files may share.
  if (sequence.capture_is_named && !sequence.capture.empty()) group.SetString("capture", sequence.capture);
  if (!sequence.actions.empty()) group.SetStrings("actions", sequence.actions);
  if (!sequence.truth_kind.empty()) group.SetString("truth_kind", sequence.truth_kind);
  if (!sequence.scene.empty()) group.SetString("scene", sequence.scene);
  const bool has_tracks = sequence.HasTracks();
  CANONPOSE_CHECK(!has_tracks || state_->tracks == TracksInDataset::kAllowed, "tracks in a file without: {}",
                  sequence.name);
  if (has_tracks) group.SetInt("frames", sequence.frame_count);
  WriteSolvedWorld(group, sequence);
  h5::Group cameras = group.Create("cameras");

  const auto frames = static_cast<std::size_t>(sequence.frame_count);
  const std::size_t joints = state_->skeleton.joints.size();
  if (!sequence.action.empty()) {
    CANONPOSE_CHECK(sequence.action.size() == frames && sequence.actions.size() <= 256, "{} actions for {} frames",
                    sequence.action.size(), frames);
    Write(group, "action", sequence.action, {frames});
  }
  for (CameraView view : sequence.cameras) {
    CheckName(state_->path, view.name, "camera");
    CANONPOSE_CHECK(view.keypoints.size() == frames * joints * 2 && view.confidence.size() == frames * joints,
                    "{} and {} values for {} frames", view.keypoints.size(), view.confidence.size(), frames);
    for (const auto* cameras_of_view : {&view.calibration, &view.solved_calibration}) {
      CANONPOSE_CHECK(cameras_of_view->size() <= 1 || cameras_of_view->size() == frames, "{} cameras for {} frames",
                      cameras_of_view->size(), frames);
    }
    h5::Group camera = cameras.Create(view.name);
    const DatasetPlace place{state_->path.string(), camera.path(), &state_->skeleton};
    camera.SetInts("image_size", {view.image_size[0], view.image_size[1]});
    if (view.time_offset_seconds != 0.0) camera.SetDouble("time_offset_seconds", view.time_offset_seconds);
    if (has_tracks) {
      WriteTracks(place, view, sequence.frame_count, camera);
    } else {
      CheckKeypoints(place, view.keypoints, view.confidence);
      Write(camera, "keypoints", view.keypoints, {frames, joints, 2});
      Write(camera, "confidence", view.confidence, {frames, joints});
    }
    for (const auto& [array, poses] : {std::pair("truth", &view.truth), std::pair("solved", &view.solved)}) {
      if (poses->empty()) continue;
      CANONPOSE_CHECK(poses->positions().size() == frames * joints * 3, "{} values for {} frames",
                      poses->positions().size(), frames);
      CheckPoses(poses->positions(), array, place);
      Write(camera, array, poses->positions(), {frames, joints, 3});
    }
    if (!view.solved.empty()) WriteSolvedDetails(camera, view.solved);
    if (!view.solved_frames.empty()) {
      CANONPOSE_CHECK(view.solved_frames.size() == frames, "{} times for {} frames", view.solved_frames.size(), frames);
      Write(camera, "solved_frames", view.solved_frames, {frames});
    }
    WriteCameras(camera, view.calibration);
    WriteCameras(camera, view.solved_calibration, "solved_");
  }
}

void DatasetWriter::Commit() {
  CANONPOSE_CHECK(state_ != nullptr, "the file has already been committed");
  // The file is closed only once none of its groups is open.
  state_->sequences = h5::Group();
  state_->file.Commit();
  state_.reset();
}

void WriteDataset(const std::filesystem::path& path, const Dataset& dataset) {
  const bool has_tracks = std::ranges::any_of(dataset.sequences, &Sequence::HasTracks);
  DatasetWriter writer(path, dataset.skeleton, dataset.source,
                       has_tracks ? TracksInDataset::kAllowed : TracksInDataset::kRefused);
  for (const Sequence& sequence : dataset.sequences) writer.Add(sequence);
  writer.Commit();
}

}  // namespace canonpose
