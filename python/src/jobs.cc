// What the commands import, simulate, solve and evaluate do, as functions.
#include "jobs.h"

#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "networks.h"
#include "python.h"
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/callbacks.h"
#include "canonpose/base/temporary_folder.h"
#include "canonpose/data/duplicates.h"
#include "canonpose/data/import.h"
#include "canonpose/data/merge.h"
#include "canonpose/data/readers/benchmarks/benchmark.h"
#include "canonpose/evaluate/report.h"
#include "canonpose/pipeline/bootstrap.h"
#include "canonpose/pipeline/evaluate_datasets.h"
#include "canonpose/simulate/simulator.h"
#include "canonpose/solve/solver.h"

namespace canonpose::python {
namespace {

namespace fs = std::filesystem;

using Paths = std::variant<fs::path, std::vector<fs::path>>;

std::vector<fs::path> ListOf(const Paths& paths) {
  if (const auto* one = std::get_if<fs::path>(&paths)) return {*one};
  return std::get<std::vector<fs::path>>(paths);
}

FrameAlignment ParseAlignment(const std::string& text) {
  if (text == "automatic") return FrameAlignment::kAutomatic;
  if (text == "order") return FrameAlignment::kOrder;
  if (text == "frame-number") return FrameAlignment::kFrameNumber;
  ThrowInvalidArgument("`align`: expected automatic, order or frame-number, found {}", text);
}

void AddImport(py::module_& module) {
  module.def(
      "import_keypoints",
      [](const std::string& format, const Paths& paths, const std::map<std::string, fs::path>& cameras,
         const std::string& layout, const std::string& skeleton, int person, std::array<int, 2> image_size,
         const std::optional<fs::path>& calibration, const std::string& name, const std::string& subject,
         const std::string& capture, double fps, bool moving_cameras, const std::string& align) {
        ImportOptions options;
        options.format = format;
        options.paths = ListOf(paths);
        for (const auto& [camera, path] : cameras) options.cameras.push_back({camera, path});
        options.layout = layout;
        options.skeleton = skeleton;
        options.person = person;
        options.image_size = image_size;
        options.calibration = calibration.value_or("");
        options.name = name;
        options.subject = subject;
        options.capture = capture;
        options.fps = fps;
        options.moving_cameras = moving_cameras;
        options.alignment = ParseAlignment(align);
        return Result({py::none()}, [&] {
          options.Validate();
          return std::make_shared<Dataset>(ImportDetections(options));
        });
      },
      py::arg("format"), py::arg("paths") = std::vector<fs::path>(), py::kw_only(),
      py::arg("cameras") = std::map<std::string, fs::path>(), py::arg("layout") = "", py::arg("skeleton") = "",
      py::arg("person") = 1, py::arg("image_size") = std::array<int, 2>{0, 0}, py::arg("calibration") = py::none(),
      py::arg("name") = "clip", py::arg("subject") = "", py::arg("capture") = "", py::arg("fps") = 0.0,
      py::arg("moving_cameras") = false, py::arg("align") = "automatic",
      "A dataset from the files of a detector: one folder or file per camera in `paths`, a folder of them, or by name "
      "in `cameras`. See docs/recording.md.");
  module.def(
      "import_benchmark",
      [](const std::string& format, const Paths& paths, const std::optional<fs::path>& calibration,
         const std::string& skeleton, const std::vector<std::string>& cameras) {
        BenchmarkOptions options;
        options.format = format;
        options.paths = ListOf(paths);
        options.calibration = calibration.value_or("");
        options.skeleton = skeleton;
        options.cameras = cameras;
        return Result({py::none()}, [&] {
          options.Validate();
          return std::make_shared<Dataset>(ImportBenchmark(options));
        });
      },
      py::arg("format"), py::arg("paths"), py::kw_only(), py::arg("calibration") = py::none(), py::arg("skeleton") = "",
      py::arg("cameras") = std::vector<std::string>(),
      "A dataset from the files of a benchmark: h36m, 3dhp-train, 3dhp-test, skipose, canonpose-detections.");
}

void AddSimulate(py::module_& module) {
  module.def(
      "simulate",
      [](const std::string& rig, int cameras, int subjects, int clips, double seconds, double fps,
         const std::vector<std::string>& activities, double noise, std::uint64_t seed, const py::object& progress) {
        SimulationOptions options;
        options.rig.kind = rig;
        options.rig.cameras = cameras;
        options.subjects = subjects;
        options.clips = clips;
        options.seconds = seconds;
        options.fps = fps;
        for (const std::string& activity : activities) options.activities.push_back(ParseActivity(activity));
        options.detector.noise = noise;
        options.seed = seed;
        return Result({progress}, [&] {
          const Simulator simulator(options);
          auto dataset = std::make_shared<Dataset>();
          dataset->skeleton = simulator.skeleton();
          dataset->source = simulator.source();
          ClipStream stream(simulator, 0);
          while (std::optional<SimulatedClip> clip = stream.Next()) {
            ThrowIfStopRequested();
            dataset->sequences.push_back(std::move(clip->sequence));
          }
          return dataset;
        });
      },
      py::arg("rig") = "studio", py::kw_only(), py::arg("cameras") = 0, py::arg("subjects") = 4, py::arg("clips") = 0,
      py::arg("seconds") = 10.0, py::arg("fps") = 0.0, py::arg("activities") = std::vector<std::string>(),
      py::arg("noise") = 1.0, py::arg("seed") = 0, py::arg("progress") = py::none(),
      "Simulated people before simulated cameras, with truth. See docs/simulation.md.");
}

/// What solve() returns.
struct Solved {
  std::shared_ptr<Dataset> dataset;
  SolveReport report;
};

Solved RunSolve(const DataArguments& data, const BootstrapOptions& bootstrap, const SolveOptions& options,
                const std::string& frames) {
  options.Validate();
  NamedDatasets all = ReadAll(AsList(data), frames);
  if (all.datasets.size() > 1) RequireDistinctRecordings(all.datasets, all.files);
  Solved solved{std::make_shared<Dataset>(MergeDatasets(std::move(all.datasets), all.files)), {}};
  const std::string name = fmt::format("{}", fmt::join(all.files, ", "));
  options.RequireSizesOf(*solved.dataset);
  const StartPoses start = Bootstrap(*solved.dataset, name, bootstrap);
  solved.report = Solve(*solved.dataset, start, options);
  return solved;
}

/// One height in metres of everybody, or heights by person.
using Heights = std::variant<std::monostate, double, std::map<std::string, double>>;
/// Metres by the names of two cameras.
using CameraDistances = std::map<std::pair<std::string, std::string>, double>;

WorldMeasures MeasuresOf(const Heights& heights, const CameraDistances& distances) {
  WorldMeasures measures;
  if (const auto* height = std::get_if<double>(&heights)) {
    measures.heights.push_back(KnownHeight::Parse(fmt::format("{}", *height)));
  }
  if (const auto* by_person = std::get_if<std::map<std::string, double>>(&heights)) {
    for (const auto& [person, height] : *by_person) {
      measures.heights.push_back(KnownHeight::Parse(fmt::format("{}={}", person, height)));
    }
  }
  for (const auto& [cameras, distance] : distances) {
    measures.distances.push_back(
        KnownDistance::Parse(fmt::format("{},{}={}", cameras.first, cameras.second, distance)));
  }
  return measures;
}

void AddSolve(py::module_& module) {
  py::class_<Solved>(module, "Solved", "What solve() found.")
      .def_readonly("dataset", &Solved::dataset, "The data with 3D poses and cameras.")
      .def_property_readonly(
          "scenes", [](const Solved& s) { return py::module_::import("canonpose").attr("scenes_of")(s.dataset); },
          "A Scene for every sequence.")
      .def_property_readonly(
          "report", [](const Solved& s) { return FromJson(s.report.ToJson()); },
          "What was found of each capture and camera, as solve writes it as JSON.")
      .def_property_readonly(
          "doubt", [](const Solved& s) { return s.report.Doubt(); },
          "Why the poses cannot be believed; '' where nothing speaks against them.")
      .def("__str__", [](const Solved& s) { return s.report.ToText(); });
  module.def(
      "solve",
      [](const DataArguments& data, const std::optional<fs::path>& model, const std::string& start,
         const std::string& mirror, const std::string& frames, int threads, std::uint64_t seed,
         const std::string& device, const Heights& height, const CameraDistances& camera_distances,
         bool calibrated_scale, const std::string& distortion, const std::vector<std::vector<std::string>>& same_lens,
         const py::object& progress) {
        BootstrapOptions bootstrap;
        bootstrap.kind = start;
        bootstrap.model = model.value_or("");
        bootstrap.seed = seed;
        bootstrap.threads = threads;
        bootstrap.device = device;
        SolveOptions options;
        options.mirror = mirror;
        options.threads = threads;
        options.measures = MeasuresOf(height, camera_distances);
        options.calibrated_scale = calibrated_scale;
        options.distortion = distortion;
        options.same_lens = same_lens;
        return Result({progress}, [&] { return RunSolve(data, bootstrap, options, frames); });
      },
      py::arg("data"), py::kw_only(), py::arg("model") = py::none(), py::arg("bootstrap") = "auto",
      py::arg("mirror") = "auto", py::arg("frames") = "", py::arg("threads") = 0, py::arg("seed") = 0,
      py::arg("device") = "cpu", py::arg("height") = py::none(), py::arg("camera_distances") = CameraDistances(),
      py::arg("calibrated_scale") = false, py::arg("distortion") = "auto",
      py::arg("same_lens") = std::vector<std::vector<std::string>>(), py::arg("progress") = py::none(),
      "Finds the 3D poses and the cameras of recordings from keypoints alone. `data`: a dataset or the path of one, or "
      "several that are solved together; they stay as they are. For millimetres: `height` in metres of the person, or "
      "{name: metres}; or `camera_distances`, {(camera, camera): metres}; or `calibrated_scale`. `distortion`: "
      "'auto', of the lenses where the keypoints show it, or 'none'; `same_lens`: lists of cameras that share a lens. "
      "`progress(label, done, total, detail)` is called now and then; what it raises stops the work. See "
      "docs/solve.md.");
}

/// Datasets in memory are evaluated from files, too.
std::vector<fs::path> AsFiles(const std::vector<DataArgument>& data, const TemporaryFolder& folder) {
  std::vector<fs::path> files;
  for (const DataArgument& one : data) {
    if (const auto* path = std::get_if<fs::path>(&one)) {
      files.push_back(*path);
    } else {
      files.push_back(folder / fmt::format("dataset-{}.h5", files.size() + 1));
      WriteDataset(files.back(), *std::get<std::shared_ptr<Dataset>>(one));
    }
  }
  return files;
}

void AddEvaluate(py::module_& module) {
  module.def(
      "evaluate",
      [](const DataArguments& data, const std::optional<fs::path>& model, const std::string& protocol,
         const std::string& frames, const std::vector<std::string>& exclude_joints, bool triangulate,
         const std::string& device, const py::object& progress) {
        const EvaluationReport report = Result({progress}, [&] {
          DatasetEvaluation job;
          const TemporaryFolder folder;
          job.files = AsFiles(AsList(data), folder);
          job.protocol = FindProtocol(protocol);
          if (!frames.empty()) job.frames = FrameRange::Parse(frames);
          job.left_out = exclude_joints;
          if (model) return EvaluateModel(*model, device, job);
          job.with_cameras = !triangulate;
          return EvaluateDatasets(job, triangulate ? TriangulatedPoses() : SolvedPoses());
        });
        return FromJson(ReportAsJson(report));
      },
      py::arg("data"), py::kw_only(), py::arg("model") = py::none(), py::arg("protocol") = kAllFrames,
      py::arg("frames") = "", py::arg("exclude_joints") = std::vector<std::string>(), py::arg("triangulate") = false,
      py::arg("device") = "cpu", py::arg("progress") = py::none(),
      "Measures solved datasets, a model's poses of them, or the triangulation of their calibrated cameras, against "
      "truth. Returns the figures of evaluate's JSON. See docs/evaluation.md.");
}

}  // namespace

std::vector<DataArgument> AsList(const DataArguments& data) {
  if (const auto* one = std::get_if<DataArgument>(&data)) return {*one};
  const auto& several = std::get<std::vector<DataArgument>>(data);
  if (several.empty()) ThrowInvalidArgument("`data`: expected at least one dataset");
  return several;
}

NamedDatasets ReadAll(const std::vector<DataArgument>& data, const std::string& frames) {
  NamedDatasets all;
  for (const DataArgument& one : data) {
    if (const auto* path = std::get_if<fs::path>(&one)) {
      all.files.push_back(path->string());
      all.datasets.push_back(ReadDataset(*path));
    } else {
      all.files.push_back(fmt::format("dataset {}", all.files.size() + 1));
      all.datasets.push_back(*std::get<std::shared_ptr<Dataset>>(one));
    }
    if (!frames.empty()) KeepFrames(all.datasets.back(), FrameRange::Parse(frames), all.files.back());
  }
  return all;
}

py::object FromJson(const std::string& text) { return py::module_::import("json").attr("loads")(text); }

void AddJobs(py::module_& module) {
  AddImport(module);
  AddSimulate(module);
  AddSolve(module);
  AddEvaluate(module);
}

}  // namespace canonpose::python
