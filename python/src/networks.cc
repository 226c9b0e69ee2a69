// Training and lifting.
#include "networks.h"

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <optional>

#include "jobs.h"
#include "python.h"
#include <fmt/format.h>

#include "canonpose/base/log.h"
#include "canonpose/export/lift_output.h"
#include "canonpose/lift/pose_lifter.h"
#include "canonpose/model/runtime.h"
#include "canonpose/pipeline/lift_views.h"
#include "canonpose/pipeline/model_poses.h"
#include "canonpose/pipeline/solve_then_train.h"
#include "canonpose/train/trainer.h"

namespace canonpose::python {
namespace {

namespace fs = std::filesystem;

using Ref = py::return_value_policy;

/// An opened model, and what it is called in messages.
struct Model {
  fs::path path;
  std::shared_ptr<const PoseLifter> lifter;
};

Model OpenModel(const fs::path& path, const std::string& device) {
  return Result({py::none()}, [&] {
    Model model{path, std::make_shared<const PoseLifter>(PoseLifter::Open(path, device))};
    for (const std::string& doubt : DoubtsAbout(model.lifter->info())) {
      LogWarning("{}: do not rely on its 3D poses: {}", path.string(), doubt);
    }
    return model;
  });
}

/// Keypoints (T, J, 2), or (T, J, 3) with confidences.
LiftInput InputOf(const Floats& array, std::array<int, 2> image_size, double fps, const Skeleton& skeleton) {
  const bool has_confidence = array.ndim() == 3 && array.shape(2) == 3;
  RequireShape(array, {-1, skeleton.joint_count(), has_confidence ? 3 : 2}, "input");
  LiftInput input;
  input.fps = fps;
  input.view.image_size = image_size;
  input.frames.resize(static_cast<std::size_t>(array.shape(0)));
  std::iota(input.frames.begin(), input.frames.end(), 0);
  const py::ssize_t width = array.shape(2);
  for (const float* row = array.data(); row != array.data() + array.size(); row += width) {
    const bool is_seen = std::isfinite(row[0]) && std::isfinite(row[1]) && (!has_confidence || row[2] > 0.0F);
    for (int k = 0; k < 2; ++k) input.view.keypoints.push_back(is_seen ? row[k] : std::nanf(""));
    input.view.confidence.push_back(!is_seen ? 0.0F : has_confidence ? row[2] : 1.0F);
  }
  return input;
}

LiftedPoses Lift(const Model& model, const std::variant<Floats, fs::path>& from, LiftChoice choice, double fps,
                 const LiftOptions& options, const py::object& progress) {
  std::optional<LiftInput> given;
  if (const auto* array = std::get_if<Floats>(&from)) {
    given = InputOf(*array, choice.image_size, fps, model.lifter->skeleton());
  }
  return Result({progress}, [&] {
    const ThreadScope one_thread(0);
    if (given) return LiftViews(*model.lifter, *given, options, "the array");
    const auto& path = std::get<fs::path>(from);
    return LiftViews(*model.lifter, ReadLiftInput(path, choice, *model.lifter), options, path.string());
  });
}

void AddLift(py::module_& module) {
  py::class_<LiftedPoses>(module, "LiftedPoses", "3D poses that a model made of the 2D poses of one camera.")
      .def_property_readonly(
          "pose_in_camera", [](LiftedPoses& p) -> PoseSequence& { return p.pose_in_camera; }, Ref::reference_internal,
          "About the root, with the axes of the camera.")
      .def_property_readonly(
          "canonical", [](LiftedPoses& p) -> PoseSequence& { return p.canonical; }, Ref::reference_internal,
          "About the root, with axes that move with the body.")
      .def_property_readonly(
          "rotation",
          [](const py::object& self) {
            auto& poses = self.cast<LiftedPoses&>();
            return View(poses.rotation, {poses.frame_count(), 3, 3}, self);
          },
          "(T, 3, 3) from canonical to camera; not a copy.")
      .def_property_readonly(
          "frames",
          [](const py::object& self) {
            auto& poses = self.cast<LiftedPoses&>();
            return View(poses.frames, {poses.frame_count()}, self);
          },
          "(T) numbers of the frames in the input.")
      .def(
          "write",
          [](const LiftedPoses& poses, const fs::path& path) {
            Run({py::none()}, [&] { WriteLiftOutput(path, poses); });
          },
          py::arg("path"), "Writes .npz, .csv or .json.")
      .def("__len__", &LiftedPoses::frame_count);
  py::class_<Model>(module, "Model", "A trained lifter.")
      .def_property_readonly("skeleton", [](const Model& m) { return m.lifter->skeleton(); })
      .def_property_readonly(
          "doubts", [](const Model& m) { return DoubtsAbout(m.lifter->info()); },
          "Why its poses cannot be believed; empty for most models.")
      .def_readonly("path", &Model::path)
      .def("__repr__", [](const Model& m) { return fmt::format("<canonpose.Model {}>", m.path.string()); });
  module.def("open_model", &OpenModel, py::arg("path"), py::arg("device") = "cpu",
             "A model file, or the folder of a finished run.");
  module.def(
      "lift",
      [](const std::variant<Model, fs::path>& model, const std::variant<Floats, fs::path>& input,
         const std::string& camera, const std::string& sequence, const std::string& frames, const std::string& format,
         const std::string& layout, int person, std::array<int, 2> image_size, double fps, std::optional<double> height,
         std::optional<int> smooth, bool fill, const py::object& progress) {
        const auto* path = std::get_if<fs::path>(&model);
        return Lift(path != nullptr ? OpenModel(*path, "cpu") : std::get<Model>(model), input,
                    {camera, sequence, frames, format, layout, image_size, person}, fps, {height, smooth, fill},
                    progress);
      },
      py::arg("model"), py::arg("input"), py::kw_only(), py::arg("camera") = "", py::arg("sequence") = "",
      py::arg("frames") = "", py::arg("format") = "", py::arg("layout") = "", py::arg("person") = 1,
      py::arg("image_size") = std::array<int, 2>{0, 0}, py::arg("fps") = 0.0, py::arg("height") = py::none(),
      py::arg("smooth") = py::none(), py::arg("fill") = false, py::arg("progress") = py::none(),
      "3D poses of one camera. `input`: keypoints (T, J, 2) in pixels or (T, J, 3) with confidences, of the model's "
      "joints; or the path of a dataset or of a detector's files. `height` in metres, for millimetres; `smooth`: an "
      "odd number of frames; `fill`: keep guesses of joints that were not seen.");
}

/// "True" and "False" as training options spell them.
std::string Spelled(const py::handle& value) {
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  return py::str(value);
}

TrainOptions OptionsOf(const std::string& preset, const py::kwargs& options, const fs::path& run_folder, bool resume) {
  const std::optional<TrainOptions> recorded = resume ? RecordedOptions(run_folder) : std::nullopt;
  TrainOptions chosen = recorded ? *recorded : PresetOptions(preset);
  for (const auto& [name, value] : options) chosen.Set(py::str(name), Spelled(value));
  if (recorded) {
    for (const std::string& name : chosen.Differences(*recorded)) {
      ThrowInvalidArgument(
          "{} was started with {} = {}, not {}: leave it out to continue, or train into another folder",
          run_folder.string(), name, recorded->Get(name), chosen.Get(name));
    }
  }
  chosen.Validate();
  return chosen;
}

void AddTrain(py::module_& module) {
  module.def(
      "train",
      [](const DataArguments& data, const fs::path& output, const std::string& preset, bool resume, bool overwrite,
         const std::string& frames, const py::object& progress, const py::kwargs& options) {
        TrainJob job;
        job.options = OptionsOf(preset, options, output, resume);
        job.run_folder = output;
        job.resume = resume;
        job.overwrite = overwrite;
        const TrainReport report = Result({progress}, [&] {
          NamedDatasets all = ReadAll(AsList(data), frames);
          job.datasets = std::move(all.datasets);
          for (const std::string& file : all.files) job.data_files.push_back(fs::path(file).filename().string());
          return job.options.supervision == Supervision::kSolved ? SolveThenTrain(job) : Train(job);
        });
        if (report.stopped) throw Error(ErrorKind::kStopped, "stopped and saved; to continue, train with `resume`");
        return OpenModel(output, job.options.device);
      },
      py::arg("data"), py::arg("output"), py::kw_only(), py::arg("preset") = "best", py::arg("resume") = false,
      py::arg("overwrite") = false, py::arg("frames") = "", py::arg("progress") = py::none(),
      "Trains a lifter on recordings, without labels or calibration, in the folder `output`. Further arguments are "
      "training options (docs/training-options.md): epochs=20, width=256, seed=1. A run that Ctrl-C or `progress` "
      "stopped has saved its state: `resume` continues it.");
}

}  // namespace

EvaluationReport EvaluateModel(const fs::path& model, const std::string& device, const DatasetEvaluation& job) {
  const ThreadScope one_thread(0);
  const PoseLifter lifter = PoseLifter::Open(model, device);
  return EvaluateDatasets(job, ModelPoses(lifter));
}

void AddNetworks(py::module_& module) {
  AddLift(module);
  AddTrain(module);
}

}  // namespace canonpose::python
