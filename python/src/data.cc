// Skeletons, cameras, poses and datasets as Python objects. Their arrays are views of the objects' own memory, whose
// size never changes.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <variant>

#include "python.h"
#include <fmt/format.h>
#include <pybind11/eigen.h>

#include "canonpose/data/dataset.h"
#include "canonpose/geometry/camera.h"
#include "canonpose/scene/pose_sequence.h"
#include "canonpose/skeleton/skeleton.h"

namespace canonpose::python {
namespace {

using Ref = py::return_value_policy;

Skeleton MakeSkeleton(const std::vector<std::string>& joints, const std::vector<int>& parents,
                      const std::optional<std::vector<int>>& mirror, const std::string& name) {
  Skeleton skeleton{name, joints, parents, 0, {}};
  for (std::size_t j = 0; j < parents.size(); ++j) {
    if (parents[j] < 0) skeleton.root = static_cast<int>(j);
  }
  for (std::size_t j = 0; j < joints.size(); ++j) {
    skeleton.mirror.push_back(mirror && j < mirror->size() ? (*mirror)[j] : static_cast<int>(j));
  }
  const std::string problem = skeleton.Problem();
  if (!problem.empty()) ThrowInvalidArgument("no skeleton: {}", problem);
  return skeleton;
}

Skeleton NamedSkeleton(const std::string& name) {
  const Skeleton* skeleton = FindSkeleton(name);
  if (skeleton == nullptr) ThrowInvalidArgument("`name`: expected {}, found {}", BuiltinSkeletonNames(), name);
  return *skeleton;
}

LengthUnit ParseUnit(const std::string& unit) {
  for (const LengthUnit one : {LengthUnit::kMillimetres, LengthUnit::kBodyLengths, LengthUnit::kEachItsOwn}) {
    if (ToString(one) == unit) return one;
  }
  ThrowInvalidArgument("`unit`: expected mm, body lengths or each pose its own, found {}", unit);
}

void Assign(std::vector<float>& values, const Floats& array, const std::vector<py::ssize_t>& shape,
            const std::string& name) {
  RequireShape(array, shape, name);
  std::copy(array.data(), array.data() + array.size(), values.begin());
}

PoseSequence MakePoses(const Skeleton& skeleton, const Floats& positions, const std::optional<Floats>& confidence,
                       double fps, const std::string& unit, const std::string& name) {
  RequireShape(positions, {-1, skeleton.joint_count(), 3}, "positions");
  PoseSequence poses(skeleton, Values(positions));
  if (confidence) Assign(poses.confidence(), *confidence, {poses.frame_count(), poses.joint_count()}, "confidence");
  poses.fps = fps;
  poses.unit = ParseUnit(unit);
  poses.name = name;
  return poses;
}

/// A sequence of a dataset, which it keeps alive. Sequences are never added to a dataset, so they stay where they are.
struct SequenceRef {
  std::shared_ptr<Dataset> dataset;
  std::size_t index = 0;

  [[nodiscard]] Sequence& get() const { return dataset->sequences[index]; }
};

struct ViewRef {
  SequenceRef sequence;
  std::size_t index = 0;

  [[nodiscard]] CameraView& get() const { return sequence.get().cameras[index]; }
  [[nodiscard]] std::vector<py::ssize_t> Shape() const {
    return {sequence.get().frame_count, sequence.dataset->skeleton.joint_count()};
  }
};

template <typename Value>
Value ValueOf(const std::map<std::string, Value>& values, const std::string& name) {
  const auto found = values.find(name);
  return found == values.end() ? Value() : found->second;
}

using ImageSize = std::array<int, 2>;

/// What Sequence() in Python takes of each camera.
struct NewViews {
  std::map<std::string, Floats> keypoints;
  std::map<std::string, Floats> confidence;
  std::map<std::string, Floats> truth;
  std::variant<ImageSize, std::map<std::string, ImageSize>> image_size;  ///< of all, or of each
  std::map<std::string, std::vector<Camera>> calibration;

  /// Names of cameras that have no keypoints are mistakes.
  void RequireKnownCameras() const {
    const auto require = [&](const auto& values, const char* argument) {
      for (const auto& [name, value] : values) {
        if (!keypoints.contains(name)) ThrowInvalidArgument("`{}`: there is no camera {}", argument, name);
      }
    };
    require(confidence, "confidence");
    require(truth, "truth");
    if (const auto* sizes = std::get_if<std::map<std::string, ImageSize>>(&image_size)) require(*sizes, "image_size");
    require(calibration, "calibration");
  }
};

CameraView MakeView(const NewViews& views, const std::string& name, const Skeleton& skeleton, py::ssize_t frames) {
  const std::vector<py::ssize_t> shape = {frames, skeleton.joint_count()};
  const Floats& keypoints = views.keypoints.at(name);
  RequireShape(keypoints, {shape[0], shape[1], 2}, "keypoints");
  CameraView view;
  view.name = name;
  const auto* one_size = std::get_if<ImageSize>(&views.image_size);
  view.image_size = one_size != nullptr ? *one_size : ValueOf(std::get<1>(views.image_size), name);
  if (view.image_size[0] <= 0 || view.image_size[1] <= 0) {
    ThrowInvalidArgument("`image_size` of {}: expected width and height in pixels, found {} and {}", name,
                         view.image_size[0], view.image_size[1]);
  }
  view.keypoints = Values(keypoints);
  view.confidence.assign(view.keypoints.size() / 2, 1.0F);
  if (views.confidence.contains(name)) Assign(view.confidence, views.confidence.at(name), shape, "confidence");
  for (std::size_t i = 0; i < view.confidence.size(); ++i) {
    const bool has_position = std::isfinite(view.keypoints[2 * i]) && std::isfinite(view.keypoints[2 * i + 1]);
    if (has_position && view.confidence[i] > 0.0F) continue;
    view.confidence[i] = 0.0F;
    view.keypoints[2 * i] = view.keypoints[2 * i + 1] = std::nanf("");
  }
  view.calibration = ValueOf(views.calibration, name);
  if (view.calibration.size() > 1 && static_cast<py::ssize_t>(view.calibration.size()) != frames) {
    ThrowInvalidArgument("`calibration` of {}: expected one camera, or {}, found {}", name, frames,
                         view.calibration.size());
  }
  if (views.truth.contains(name)) {
    RequireShape(views.truth.at(name), {shape[0], shape[1], 3}, "truth");
    view.truth = TruthPoses(skeleton, Values(views.truth.at(name)), name);
  }
  return view;
}

SequenceRef MakeSequence(const Skeleton& skeleton, const std::string& name, const NewViews& views, double fps,
                         const std::string& subject, const std::string& capture, bool static_cameras) {
  if (views.keypoints.empty()) ThrowInvalidArgument("`keypoints`: expected those of at least one camera");
  views.RequireKnownCameras();
  auto dataset = std::make_shared<Dataset>();
  dataset->skeleton = skeleton;
  Sequence sequence;
  sequence.name = name;
  sequence.subject = subject.empty() ? name : subject;
  sequence.fps = fps;
  sequence.static_cameras = static_cameras;
  sequence.capture_is_named = !capture.empty();
  sequence.capture = sequence.capture_is_named ? capture : static_cameras ? sequence.subject : name;
  const Floats& first = views.keypoints.begin()->second;
  RequireShape(first, {-1, skeleton.joint_count(), 2}, "keypoints");
  sequence.frame_count = static_cast<int>(first.shape(0));
  for (const auto& [camera, keypoints] : views.keypoints) {
    sequence.cameras.push_back(MakeView(views, camera, skeleton, first.shape(0)));
  }
  dataset->sequences.push_back(std::move(sequence));
  return {dataset, 0};
}

std::shared_ptr<Dataset> MakeDataset(const std::vector<SequenceRef>& sequences) {
  if (sequences.empty()) ThrowInvalidArgument("`sequences`: expected at least one");
  auto dataset = std::make_shared<Dataset>();
  dataset->skeleton = sequences.front().dataset->skeleton;
  dataset->source = sequences.front().dataset->source;
  for (const SequenceRef& sequence : sequences) {
    const std::string& name = sequence.get().name;
    if (!sequence.dataset->skeleton.SameJoints(dataset->skeleton)) {
      ThrowInvalidArgument("sequence {} has another skeleton than sequence {}", name, sequences.front().get().name);
    }
    for (const Sequence& other : dataset->sequences) {
      if (other.name == name) ThrowInvalidArgument("two sequences are named {}", name);
    }
    dataset->sequences.push_back(sequence.get());
  }
  return dataset;
}

void AddSkeleton(py::module_& module) {
  py::class_<Skeleton>(module, "Skeleton", "Named joints, their parents and left-right partners.")
      .def(py::init(&MakeSkeleton), py::arg("joints"), py::arg("parents"), py::arg("mirror") = py::none(),
           py::arg("name") = "",
           "`parents` and `mirror` are indices; the root has the parent -1. Without `mirror`, no joint has a partner.")
      .def_static("named", &NamedSkeleton, py::arg("name"), "A built-in skeleton: h36m-17, body_25, coco-17, ...")
      .def_readonly("name", &Skeleton::name)
      .def_property_readonly("joints", [](const Skeleton& s) { return py::tuple(py::cast(s.joints)); })
      .def_property_readonly("parents", [](const Skeleton& s) { return py::tuple(py::cast(s.parents)); })
      .def_property_readonly("mirror", [](const Skeleton& s) { return py::tuple(py::cast(s.mirror)); })
      .def_readonly("root", &Skeleton::root)
      .def(
          "index",
          [](const Skeleton& skeleton, const std::string& joint) {
            const std::optional<int> found = skeleton.Find(joint);
            if (!found) ThrowInvalidArgument("the skeleton has no joint {}", joint);
            return *found;
          },
          py::arg("joint"), "The index of a joint by name, ignoring case.")
      .def("__len__", &Skeleton::joint_count)
      .def("__repr__", [](const Skeleton& s) {
        return fmt::format("<canonpose.Skeleton {} of {} joints>", s.name.empty() ? "without a name" : s.name,
                           s.joint_count());
      });
}

void AddCamera(py::module_& module) {
  py::class_<Camera>(module, "Camera",
                     "A pinhole camera: x_in_camera = R @ x_in_world + t. x right, y down, z forward.")
      .def(py::init([](const Eigen::Matrix3d& k, const Eigen::Matrix3d& r, const Eigen::Vector3d& t,
                       const std::vector<double>& distortion) {
             Camera camera;
             camera.K = k;
             camera.camera_from_world_rotation = r;
             camera.camera_from_world_translation = t;
             if (distortion.size() > 5) ThrowInvalidArgument("`distortion`: expected up to 5 values");
             std::copy(distortion.begin(), distortion.end(), camera.distortion.begin());
             return camera;
           }),
           py::arg("K"), py::arg("R"), py::arg("t"), py::arg("distortion") = std::vector<double>())
      .def_property_readonly("K", [](const Camera& c) { return c.K; })
      .def_property_readonly("R", [](const Camera& c) { return c.camera_from_world_rotation; })
      .def_property_readonly("t", [](const Camera& c) { return c.camera_from_world_translation; })
      .def_property_readonly("distortion", [](const Camera& c) { return py::array_t<double>(5, c.distortion.data()); })
      .def(
          "project",
          [](const Camera& camera, const Doubles& points) {
            RequireShape(points, {-1, 3}, "points");
            py::array_t<double> pixels({points.shape(0), py::ssize_t{2}});
            for (py::ssize_t i = 0; i < points.shape(0); ++i) {
              const double* p = points.data(i, 0);
              const Eigen::Vector2d pixel = camera.Project({p[0], p[1], p[2]});
              pixels.mutable_at(i, 0) = pixel.x();
              pixels.mutable_at(i, 1) = pixel.y();
            }
            return pixels;
          },
          py::arg("points"), "Pixels (N, 2) of points (N, 3) in the world; NaN behind the camera.");
}

void AddPoses(py::module_& module) {
  py::class_<PoseSequence>(module, "PoseSequence",
                           "3D poses of one person over time. Missing joints are NaN with confidence 0.")
      .def(py::init(&MakePoses), py::arg("skeleton"), py::arg("positions"), py::arg("confidence") = py::none(),
           py::arg("fps") = 0.0, py::arg("unit") = "mm", py::arg("name") = "",
           "`positions` (T, J, 3) is copied; `unit` is 'mm', 'body lengths' or 'each pose its own'.")
      .def_property_readonly(
          "skeleton", [](const PoseSequence& p) -> const Skeleton& { return p.skeleton(); }, Ref::reference_internal)
      .def_property_readonly(
          "positions",
          [](const py::object& self) {
            auto& p = self.cast<PoseSequence&>();
            return View(p.positions(), {p.frame_count(), p.joint_count(), 3}, self);
          },
          "(T, J, 3), not a copy.")
      .def_property_readonly(
          "confidence",
          [](const py::object& self) {
            auto& p = self.cast<PoseSequence&>();
            return View(p.confidence(), {p.frame_count(), p.joint_count()}, self);
          },
          "(T, J), 0 to 1, not a copy.")
      .def_property_readonly(
          "standard_deviation",
          [](const py::object& self) {
            auto& p = self.cast<PoseSequence&>();
            return View(p.standard_deviation(), {p.frame_count(), p.joint_count()}, self);
          },
          "(T, J) along an axis, NaN where unknown, not a copy.")
      .def_property_readonly(
          "time",
          [](const PoseSequence& p) {
            py::array_t<double> time(p.frame_count());
            for (int t = 0; t < p.frame_count(); ++t) time.mutable_at(t) = p.TimeOf(t);
            return time;
          },
          "(T) seconds; frame numbers where no rate is known.")
      .def_property_readonly("unit", [](const PoseSequence& p) { return ToString(p.unit); })
      .def_readwrite("fps", &PoseSequence::fps, "Frames per second, 0 where unknown.")
      .def_readwrite("name", &PoseSequence::name)
      .def("copy", [](const PoseSequence& p) { return p; })
      .def("__len__", &PoseSequence::frame_count)
      .def("__repr__", [](const PoseSequence& p) {
        return fmt::format("<canonpose.PoseSequence {}of {} frames, {} joints, in {}>",
                           p.name.empty() ? "" : p.name + " ", p.frame_count(), p.joint_count(), ToString(p.unit));
      });
}

py::object PosesOrNone(PoseSequence& poses, const py::object& owner) {
  if (poses.empty()) return py::none();
  return py::cast(&poses, Ref::reference_internal, owner);
}

void AddViews(py::module_& module) {
  py::class_<ViewRef>(module, "CameraView", "What one camera of a sequence saw.")
      .def_property_readonly("name", [](const ViewRef& v) { return v.get().name; })
      .def_property_readonly(
          "image_size", [](const ViewRef& v) { return v.get().image_size; },
          "Width and height in pixels, 0 where unknown.")
      .def_property_readonly(
          "keypoints",
          [](const py::object& self) {
            const auto& view = self.cast<const ViewRef&>();
            return View(view.get().keypoints, {view.Shape()[0], view.Shape()[1], 2}, self);
          },
          "(T, J, 2) pixels, NaN where not detected; not a copy.")
      .def_property_readonly(
          "confidence",
          [](const py::object& self) {
            const auto& view = self.cast<const ViewRef&>();
            return View(view.get().confidence, view.Shape(), self);
          },
          "(T, J), 0 where not detected; not a copy.")
      .def_property_readonly("time_offset_seconds", [](const ViewRef& v) { return v.get().time_offset_seconds; })
      .def_property_readonly(
          "truth", [](const py::object& s) { return PosesOrNone(s.cast<const ViewRef&>().get().truth, s); },
          "True poses in mm in the camera's frame, or None.")
      .def_property_readonly(
          "solved", [](const py::object& s) { return PosesOrNone(s.cast<const ViewRef&>().get().solved, s); },
          "The poses that solve() found, in the camera's frame, or None.")
      .def_property_readonly(
          "calibration", [](const ViewRef& v) { return v.get().calibration; },
          "One Camera, or one per frame; empty where unknown.")
      .def_property_readonly(
          "solved_calibration", [](const ViewRef& v) { return v.get().solved_calibration; },
          "The cameras that solve() found.")
      .def("__repr__", [](const ViewRef& v) { return fmt::format("<canonpose.CameraView {}>", v.get().name); });
}

void AddSequences(py::module_& module) {
  py::class_<SequenceRef>(module, "Sequence", "Synchronised frames of one person from several cameras.")
      .def(py::init([](const Skeleton& skeleton, const std::string& name, std::map<std::string, Floats> keypoints,
                       std::variant<ImageSize, std::map<std::string, ImageSize>> image_size,
                       std::map<std::string, Floats> confidence, std::map<std::string, std::vector<Camera>> calibration,
                       std::map<std::string, Floats> truth, double fps, const std::string& subject,
                       const std::string& capture, bool static_cameras) {
             const NewViews views{std::move(keypoints), std::move(confidence), std::move(truth), std::move(image_size),
                                  std::move(calibration)};
             return MakeSequence(skeleton, name, views, fps, subject, capture, static_cameras);
           }),
           py::arg("skeleton"), py::arg("name"), py::arg("keypoints"), py::kw_only(), py::arg("image_size"),
           py::arg("confidence") = py::dict(), py::arg("calibration") = py::dict(), py::arg("truth") = py::dict(),
           py::arg("fps") = 0.0, py::arg("subject") = "", py::arg("capture") = "", py::arg("static_cameras") = true,
           "`keypoints`: by the cameras' names, arrays (T, J, 2) in pixels, NaN where not detected. `image_size`: "
           "(width, "
           "height) of all cameras, or by name. By name as well: `confidence` (T, J), without which detected joints "
           "have "
           "1; `calibration`, a "
           "list of one Camera or of T, in mm; `truth` (T, J, 3), mm in the camera's frame. Arrays are copied.")
      .def_property_readonly("name", [](const SequenceRef& s) { return s.get().name; })
      .def_property_readonly("subject", [](const SequenceRef& s) { return s.get().subject; })
      .def_property_readonly("capture", [](const SequenceRef& s) { return s.get().capture; })
      .def_property_readonly("fps", [](const SequenceRef& s) { return s.get().fps; })
      .def_property_readonly("static_cameras", [](const SequenceRef& s) { return s.get().static_cameras; })
      .def_property_readonly("skeleton", [](const SequenceRef& s) { return s.dataset->skeleton; })
      .def_property_readonly(
          "cameras",
          [](const SequenceRef& s) {
            py::dict cameras;
            for (std::size_t c = 0; c < s.get().cameras.size(); ++c) {
              cameras[py::str(s.get().cameras[c].name)] = ViewRef{s, c};
            }
            return cameras;
          },
          "CameraView by name.")
      .def("__len__", [](const SequenceRef& s) { return s.get().frame_count; })
      .def("__repr__", [](const SequenceRef& s) {
        return fmt::format("<canonpose.Sequence {} of {} frames from {} cameras>", s.get().name, s.get().frame_count,
                           s.get().cameras.size());
      });
}

void AddDatasets(py::module_& module) {
  py::class_<Dataset, std::shared_ptr<Dataset>>(module, "Dataset", "Sequences of people with one skeleton.")
      .def(py::init(&MakeDataset), py::arg("sequences"), "The sequences are copied.")
      .def_property_readonly("skeleton", [](const Dataset& d) { return d.skeleton; })
      .def_property_readonly(
          "sequences",
          [](const std::shared_ptr<Dataset>& d) {
            py::dict sequences;
            for (std::size_t s = 0; s < d->sequences.size(); ++s) {
              sequences[py::str(d->sequences[s].name)] = SequenceRef{d, s};
            }
            return sequences;
          },
          "Sequence by name.")
      .def(
          "write",
          [](const std::shared_ptr<Dataset>& d, const std::filesystem::path& path) {
            Run({py::none()}, [&] {
              RequireDatasetName(path);
              WriteDataset(path, *d);
            });
          },
          py::arg("path"), "Writes a dataset file (.h5).")
      .def("copy", [](const Dataset& d) { return std::make_shared<Dataset>(d); })
      .def("__len__", [](const Dataset& d) { return d.sequences.size(); })
      .def("__repr__",
           [](const Dataset& d) { return fmt::format("<canonpose.Dataset of {} sequences>", d.sequences.size()); });
  module.def(
      "read_dataset",
      [](const std::filesystem::path& path) {
        return Result({py::none()}, [&] { return std::make_shared<Dataset>(ReadDataset(path)); });
      },
      py::arg("path"), "Reads a dataset file, whether from import, from solve, or written with h5py.");
}

}  // namespace

void AddData(py::module_& module) {
  AddSkeleton(module);
  AddCamera(module);
  AddPoses(module);
  AddViews(module);
  AddSequences(module);
  AddDatasets(module);
}

}  // namespace canonpose::python
