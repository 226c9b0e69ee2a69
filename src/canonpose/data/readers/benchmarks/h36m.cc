#include "canonpose/data/readers/benchmarks/h36m.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/base/median.h"
#include "canonpose/data/codecs/json.h"
#include "canonpose/data/codecs/npz.h"
#include "canonpose/data/codecs/pickle.h"
#include "canonpose/data/readers/benchmarks/anatomy.h"
#include "canonpose/data/readers/benchmarks/builder.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kCameras = 4;
constexpr std::size_t kHuman36mJoints = 17;
constexpr std::size_t kStoredJoints = 32;
constexpr double kFramesPerSecond = 50.0;
/// The 17 joints that the field uses.
constexpr std::array<std::size_t, kHuman36mJoints> kKept = {0,  1,  2,  3,  6,  7,  8,  12, 13,
                                                            14, 15, 17, 18, 19, 25, 26, 27};
/// Cameras and the sizes of their images, in the order of VideoPose3D.
constexpr std::array<std::pair<const char*, std::array<int, 2>>, kCameras> kKnownCameras = {
    {{"54138969", {1000, 1002}}, {"55011271", {1000, 1000}}, {"58860488", {1000, 1000}}, {"60457274", {1000, 1002}}}};
/// With a larger error, the 2D poses do not belong to these cameras.
constexpr double kFarFromTruthPx = 60.0;

struct Lens {
  std::string name;
  std::array<int, 2> image_size{};
  Camera camera;  ///< intrinsics only
};

struct Rig {
  std::vector<Lens> lenses;
  std::map<std::string, std::vector<Camera>> cameras;  ///< by subject; empty for subjects without cameras
};

std::vector<double> NumbersOf(const JsonValue& value, std::size_t count) {
  std::vector<double> numbers = value.Numbers();
  if (numbers.size() != count) value.Fail(fmt::format("{} values", count), "", fmt::format("{}", numbers.size()));
  return numbers;
}

Lens ReadLens(const JsonValue& value) {
  Lens lens;
  const JsonValue id = value["id"];
  lens.name = id.json().is_string() ? id.String() : fmt::format("{}", id.Integer());
  const std::vector<double> centre = NumbersOf(value["center"], 2);
  const std::vector<double> focal = NumbersOf(value["focal_length"], 2);
  const std::vector<double> radial = NumbersOf(value["radial_distortion"], 3);
  const std::vector<double> tangential = NumbersOf(value["tangential_distortion"], 2);
  if (!(focal[0] > 10.0) || !(focal[1] > 10.0)) {
    value["focal_length"].Fail("focal lengths in pixels", "dump the parameters exactly as in h36m_dataset.py");
  }
  lens.camera.K << focal[0], 0.0, centre[0], 0.0, focal[1], centre[1], 0.0, 0.0, 1.0;
  lens.camera.distortion = {radial[0], radial[1], tangential[0], tangential[1], radial[2]};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const JsonValue size = value[axis == 0 ? "res_w" : "res_h"];
    const std::int64_t pixels = size.Integer();
    if (pixels < 1 || pixels > 100'000) size.Fail("a number of pixels");
    lens.image_size[axis] = static_cast<int>(pixels);
  }
  return lens;
}

Camera PlaceCamera(const JsonValue& value, const Lens& lens) {
  const std::vector<double> q = NumbersOf(value["orientation"], 4);
  const std::vector<double> place = NumbersOf(value["translation"], 3);
  const Eigen::Quaterniond world_from_camera(q[0], q[1], q[2], q[3]);
  constexpr double kTolerance = 1e-3;
  if (std::abs(world_from_camera.norm() - 1.0) > kTolerance) {
    value["orientation"].Fail("a unit quaternion w, x, y, z", "",
                              fmt::format("one of length {:.4g}", world_from_camera.norm()));
  }
  const Eigen::Vector3d centre_mm(place[0], place[1], place[2]);
  constexpr double kNearestMm = 100.0;
  if (centre_mm.norm() < kNearestMm) {
    value["translation"].Fail("the camera's position in millimetres",
                              "dump the parameters exactly as in h36m_dataset.py",
                              fmt::format("{:.3g} from the origin, so metres", centre_mm.norm()));
  }
  Camera camera = lens.camera;
  camera.camera_from_world_rotation = world_from_camera.normalized().toRotationMatrix().transpose();
  camera.camera_from_world_translation = -(camera.camera_from_world_rotation * centre_mm);
  return camera;
}

Rig ReadRig(const fs::path& path) {
  const JsonValue root = JsonValue::Load(path);
  const JsonValue intrinsic = root["intrinsic"];
  const JsonValue extrinsic = root["extrinsic"];
  Rig rig;
  if (intrinsic.ArraySize() != kCameras) intrinsic.Fail(fmt::format("{} cameras", kCameras));
  for (std::size_t i = 0; i < kCameras; ++i) rig.lenses.push_back(ReadLens(intrinsic.At(i)));
  for (const std::string& subject : extrinsic.Keys()) {
    const JsonValue views = extrinsic[subject];
    if (views.ArraySize() != kCameras) views.Fail(fmt::format("{} cameras", kCameras));
    std::vector<Camera>& cameras = rig.cameras[subject];
    for (std::size_t i = 0; i < kCameras; ++i) {
      if (views.At(i).Keys().empty()) continue;  // subjects whose cameras are not published
      cameras.push_back(PlaceCamera(views.At(i), rig.lenses[i]));
    }
    if (!cameras.empty() && cameras.size() != kCameras) views.Fail("parameters of all cameras, or of none");
  }
  return rig;
}

std::vector<Lens> KnownLenses() {
  std::vector<Lens> lenses;
  for (const auto& [name, size] : kKnownCameras) lenses.push_back({name, size, {}});
  return lenses;
}

struct Files {
  fs::path path_2d;
  fs::path path_3d;
  std::optional<pickle::Value> positions_2d;
  std::optional<pickle::Value> positions_3d;
  std::string layout = "h36m";
};

pickle::Value ReadObject(const NpzReader& file, const fs::path& path, const std::string& name) {
  return pickle::Decode(file.ReadPickle(name), path.string(), fmt::format("array {}", name)).Unwrapped();
}

Files ReadFiles(const std::vector<fs::path>& paths) {
  Files files;
  for (const fs::path& path : paths) {
    const NpzReader file(path);
    if (file.Has("positions_2d") && !files.positions_2d) {
      files.path_2d = path;
      files.positions_2d = ReadObject(file, path, "positions_2d");
      if (file.Has("metadata")) {
        const pickle::Value metadata = ReadObject(file, path, "metadata");
        if (const auto layout = metadata.Find("layout_name")) files.layout = layout->Text();
      }
    } else if (file.Has("positions_3d") && !files.positions_3d) {
      files.path_3d = path;
      files.positions_3d = ReadObject(file, path, "positions_3d");
    } else {
      ThrowBadInput({path.string(), "", "positions_2d in one file, and optionally positions_3d in another",
                     fmt::format("{}", fmt::join(file.names(), ", ")),
                     "give data_2d_h36m_*.npz and data_3d_h36m.npz of VideoPose3D"});
    }
  }
  if (!files.positions_2d) {
    ThrowBadInput({paths.front().string(), "", "2D poses, positions_2d", "only 3D poses",
                   "also give data_2d_h36m_gt.npz or another file of 2D poses"});
  }
  return files;
}

/// The 2D poses of one camera.
struct View {
  std::size_t frames = 0;
  std::vector<double> keypoints;
  std::vector<float> confidence;
  bool has_confidence = false;
};

View ReadView(const pickle::Numbers& numbers, const pickle::Value& place, const fs::path& file) {
  const std::vector<std::size_t>& shape = numbers.shape;
  if (shape.size() != 3 || shape[1] != kHuman36mJoints || (shape[2] != 2 && shape[2] != 3)) {
    place.Fail("an array (T, 17, 2) = frames, joints, pixels", "", fmt::format("shape ({})", fmt::join(shape, ", ")));
  }
  View view;
  view.frames = shape[0];
  view.has_confidence = shape[2] == 3;
  for (std::size_t i = 0; i < shape[0] * kHuman36mJoints; ++i) {
    view.keypoints.push_back(numbers.values[i * shape[2]]);
    view.keypoints.push_back(numbers.values[i * shape[2] + 1]);
    const double confidence = view.has_confidence ? numbers.values[i * shape[2] + 2] : 1.0;
    if (!std::isnan(confidence) && !(confidence >= 0.0 && confidence <= 1.0)) {
      place.Fail("confidences from 0 to 1 in the third column", "", fmt::format("{}", confidence));
    }
    view.confidence.push_back(static_cast<float>(confidence));
  }
  MarkMissing(view.keypoints, view.confidence);
  RequireFiniteOrMissing(view.keypoints, kHuman36mJoints, 2, file.string(), place.place());
  RequirePixels(view.keypoints, file.string(), place.place());
  return view;
}

/// An action's cameras: a list of arrays, or a single array if all are equally long.
std::vector<View> ReadViews(const pickle::Value& action, const fs::path& file) {
  std::vector<View> views;
  if (action.size() != kCameras) action.Fail(fmt::format("{} cameras", kCameras), "", fmt::format("{}", action.size()));
  if (!action.IsNumbers()) {
    for (std::size_t c = 0; c < kCameras; ++c) views.push_back(ReadView(action.At(c).ToNumbers(), action.At(c), file));
    return views;
  }
  const pickle::Numbers all = action.ToNumbers();
  const std::size_t size = all.values.size() / kCameras;
  for (std::size_t c = 0; c < kCameras; ++c) {
    const auto begin = all.values.begin() + static_cast<std::ptrdiff_t>(c * size);
    views.push_back(ReadView(
        {{all.shape.begin() + 1, all.shape.end()}, {begin, begin + static_cast<std::ptrdiff_t>(size)}}, action, file));
  }
  return views;
}

/// "Walking 1" -> "Walking": protocols report by action, not by trial.
std::string ActionOf(const std::string& trial) {
  const std::size_t end = trial.find_last_not_of("0123456789");
  return end != std::string::npos && end + 1 < trial.size() && end > 0 && trial[end] == ' ' ? trial.substr(0, end)
                                                                                            : trial;
}

class Human36mImporter {
 public:
  explicit Human36mImporter(const BenchmarkOptions& options) : options_(options), files_(ReadFiles(options.paths)) {
    if (files_.layout != "h36m" && files_.layout != "coco") {
      ThrowBadInput({files_.path_2d.string(), "metadata, layout_name", "h36m or coco", files_.layout,
                     "give 2D poses in Human3.6M's or COCO's joints"});
    }
    if (!options.calibration.empty()) rig_ = ReadRig(options.calibration);
    lenses_ = rig_ ? rig_->lenses : KnownLenses();
    if (!rig_ && files_.positions_3d) {
      LogWarning(
          "there is no truth without cameras, since 3D poses are in the world's frame; set `calibration` to a JSON "
          "file with VideoPose3D's h36m_cameras_extrinsic_params as \"extrinsic\" and h36m_cameras_intrinsic_params as "
          "\"intrinsic\"");
    }
  }

  Dataset Run() {
    const Skeleton& h36m = BenchmarkLayout("h36m-17");
    BenchmarkBuilder builder(options_, files_.layout == "coco" ? BenchmarkLayout("coco-17") : h36m, h36m, "h36m-17");
    for (const std::string& subject : files_.positions_2d->Keys()) {
      const pickle::Value actions = (*files_.positions_2d)[subject];
      for (const std::string& action : actions.Keys()) {
        builder.Add(ReadSequence(subject, action, actions[action]), files_.path_2d);
      }
    }
    Report();
    Dataset dataset = builder.Finish();
    if (dataset.sequences.empty()) files_.positions_2d->Fail("at least one subject with an action");
    return dataset;
  }

 private:
  Sequence ReadSequence(const std::string& subject, const std::string& action, const pickle::Value& value) {
    Sequence sequence;
    sequence.name = fmt::format("{} {}", subject, action);
    std::replace(sequence.name.begin(), sequence.name.end(), '/', '-');
    sequence.subject = subject;
    sequence.capture = subject;
    sequence.fps = kFramesPerSecond;
    sequence.actions = {ActionOf(action)};
    std::vector<View> views = ReadViews(value, files_.path_2d);
    const std::optional<std::vector<float>> world_mm = ReadWorld(subject, action);
    std::size_t frames = world_mm ? world_mm->size() / (3 * kHuman36mJoints) : views.front().frames;
    for (const View& view : views) {
      if (world_mm && view.frames < frames) {
        value.Fail(fmt::format("at least as many frames as the 3D poses have, {}", frames), "",
                   fmt::format("{}", view.frames));
      }
      if (!world_mm) frames = std::min(frames, view.frames);
    }
    if (frames == 0) value.Fail("at least one frame");
    sequence.frame_count = static_cast<int>(frames);
    const std::vector<Camera>* const cameras = CamerasOf(subject);
    for (std::size_t c = 0; c < kCameras; ++c) {
      if (views[c].frames > frames)
        cut_.push_back(fmt::format("{} ({} of {})", sequence.name, frames, views[c].frames));
      sequence.cameras.push_back(
          MakeView(std::move(views[c]), frames, lenses_[c], cameras ? &(*cameras)[c] : nullptr, world_mm));
    }
    return sequence;
  }

  CameraView MakeView(View found, std::size_t frames, const Lens& lens, const Camera* camera,
                      const std::optional<std::vector<float>>& world_mm) {
    CameraView view;
    view.name = lens.name;
    view.image_size = lens.image_size;
    found.keypoints.resize(frames * kHuman36mJoints * 2);
    found.confidence.resize(frames * kHuman36mJoints);
    view.keypoints = ToFloats(found.keypoints);
    view.confidence = std::move(found.confidence);
    has_confidence_ = has_confidence_ || found.has_confidence;
    if (camera == nullptr) return view;
    view.calibration = {*camera};
    if (!world_mm) return view;
    std::vector<float> truth;
    for (std::size_t i = 0; i < frames * kHuman36mJoints; ++i) {
      const float* const point = &(*world_mm)[3 * i];
      const Eigen::Vector3d in_camera = camera->InCamera({point[0], point[1], point[2]});
      for (int axis = 0; axis < 3; ++axis) truth.push_back(static_cast<float>(in_camera[axis]));
    }
    view.truth = TruthPoses(BenchmarkLayout("h36m-17"), std::move(truth), view.name);
    const double error_px = files_.layout == "h36m" ? MedianProjectionError(view, *camera) : std::nan("");
    if (std::isfinite(error_px)) errors_px_.push_back(error_px);
    return view;
  }

  /// (T, 17, 3) mm in the world's frame; nothing if there are none.
  std::optional<std::vector<float>> ReadWorld(const std::string& subject, const std::string& action) {
    if (!files_.positions_3d) return std::nullopt;
    const std::optional<pickle::Value> actions = files_.positions_3d->Find(subject);
    const std::optional<pickle::Value> found = actions ? actions->Find(action) : std::nullopt;
    if (!found) {
      without_3d_.push_back(fmt::format("{} {}", subject, action));
      return std::nullopt;
    }
    const pickle::Numbers numbers = found->ToNumbers();
    const std::vector<std::size_t>& shape = numbers.shape;
    if (shape.size() != 3 || shape[0] == 0 || shape[1] != kStoredJoints || shape[2] != 3) {
      found->Fail("an array (T, 32, 3) = frames, joints, x y z", "", fmt::format("shape ({})", fmt::join(shape, ", ")));
    }
    const std::string file = files_.path_3d.string();
    RequireFiniteOrMissing(numbers.values, kStoredJoints, 3, file, found->place());
    std::vector<float> kept;
    for (std::size_t t = 0; t < shape[0]; ++t) {
      for (const std::size_t joint : kKept) {
        const double* const point = &numbers.values[3 * (t * kStoredJoints + joint)];
        for (int axis = 0; axis < 3; ++axis) kept.push_back(static_cast<float>(point[axis]));
      }
    }
    const Skeleton& h36m = BenchmarkLayout("h36m-17");
    const PoseUnit unit = DetectUnit(h36m, kept, file, found->place());
    if (unit.name != unit_.name || unit_.leg_mm == 0.0) {
      LogInfo("3D poses are in {}: legs are {:.0f} mm long", unit.name, unit.leg_mm);
    }
    unit_ = unit;
    for (float& value : kept) value = static_cast<float>(value * unit.mm_per_unit);
    sides_.Add(CheckSides(h36m, kept), fmt::format("{} {}", subject, action));
    return kept;
  }

  const std::vector<Camera>* CamerasOf(const std::string& subject) {
    if (!rig_) return nullptr;
    const auto cameras = rig_->cameras.find(subject);
    if (cameras == rig_->cameras.end() || cameras->second.empty()) {
      ThrowBadInput({options_.calibration.string(), "extrinsic", fmt::format("the cameras of {}", subject), "none",
                     "dump all of VideoPose3D's parameters, or leave out `calibration`"});
    }
    return &cameras->second;
  }

  void Report() {
    if (!has_confidence_) LogInfo("the 2D poses have no confidences: all are 1");
    if (!cut_.empty()) {
      LogInfo("2D has more frames than 3D or than another camera; the rest is cut off: {}{}", cut_.front(),
              cut_.size() > 1 ? fmt::format(" and {} more views", cut_.size() - 1) : "");
    }
    if (!without_3d_.empty()) LogWarning("there are no 3D poses, and so no truth, of {}", fmt::join(without_3d_, ", "));
    sides_.Warn();
    if (errors_px_.empty()) return;
    const double median_px = Median(errors_px_);
    LogInfo("projected truth is {:.2f} px from the 2D poses (median)", median_px);
    if (median_px > kFarFromTruthPx) {
      LogWarning("that is a large error: check that 2D poses, 3D poses and cameras belong together");
    }
  }

  const BenchmarkOptions& options_;
  Files files_;
  std::optional<Rig> rig_;
  std::vector<Lens> lenses_;
  PoseUnit unit_;
  SideReport sides_;
  bool has_confidence_ = false;
  std::vector<std::string> cut_;
  std::vector<std::string> without_3d_;
  std::vector<double> errors_px_;
};

}  // namespace

Dataset ImportH36m(const BenchmarkOptions& options) {
  if (options.paths.size() > 2) {
    ThrowInvalidArgument("h36m takes the file of 2D poses and optionally that of 3D poses, not {} files",
                         options.paths.size());
  }
  return Human36mImporter(options).Run();
}

}  // namespace canonpose
