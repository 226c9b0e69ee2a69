#include "canonpose/data/readers/benchmarks/mpi_3dhp_train_set.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>
#include <utility>

#include <Eigen/LU>
#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/hdf5.h"
#include "canonpose/base/log.h"
#include "canonpose/base/median.h"
#include "canonpose/data/codecs/mat_file.h"
#include "canonpose/data/readers/benchmarks/anatomy.h"
#include "canonpose/data/readers/benchmarks/builder.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kTrainCameras = 14;
constexpr std::size_t kTrainJoints = 28;
constexpr std::array<int, 2> kTrainImageSize{2048, 2048};
constexpr const char* kTrainSetAdvice = "give annot.mat of the training set as published";
/// If the calibration belongs to the sequence, annot3 projects to annot2 up to rounding.
constexpr double kFarFromAnnot2Px = 5.0;

// ----------------------------------------------------------------------------------------------------- calibration

/// The lines of a calibration, each a key and its values.
class Lines {
 public:
  explicit Lines(const fs::path& path) : path_(path), stream_(path) {
    if (!stream_) ThrowBadInput({path.string(), "", "a file that can be read", "none", "check the path"});
  }

  /// The rest of the next non-empty line, whose first word must be `key`; the whole line if `key` is empty.
  std::string Next(const std::string& key) {
    std::string line;
    while (std::getline(stream_, line)) {
      ++number_;
      const std::size_t begin = line.find_first_not_of(" \t\r");
      if (begin == std::string::npos) continue;
      if (key.empty()) return line;
      const std::size_t end = std::min(line.find_first_of(" \t\r", begin), line.size());
      if (line.substr(begin, end - begin) != key)
        Fail(fmt::format("\"{}\"", key), fmt::format("\"{}\"", line.substr(begin, 40)));
      return line.substr(end);
    }
    ++number_;
    Fail(key.empty() ? "a first line" : fmt::format("\"{}\"", key), "the end of the file");
  }

  std::vector<double> Numbers(const std::string& key, std::size_t count) {
    std::istringstream rest(Next(key));
    std::vector<double> numbers;
    for (double value = 0.0; rest >> value;) numbers.push_back(value);
    if (numbers.size() != count || !rest.eof())
      Fail(fmt::format("{} numbers of {}", count, key), fmt::format("{}", numbers.size()));
    return numbers;
  }

  [[noreturn]] void Fail(const std::string& expected, const std::string& found) const {
    ThrowBadInput({path_.string(), fmt::format("line {}", number_), expected, found,
                   "give camera.calibration of MPI-INF-3DHP as published: one line, then seven lines per camera"});
  }

 private:
  fs::path path_;
  std::ifstream stream_;
  int number_ = 0;
};

struct CalibratedView {
  Camera camera;
  std::array<int, 2> image_size{};
};

CalibratedView ReadView(Lines& lines, std::size_t index) {
  CalibratedView view;
  if (lines.Numbers("name", 1)[0] != static_cast<double>(index)) lines.Fail(fmt::format("camera {}", index), "another");
  lines.Next("sensor");
  const std::vector<double> size = lines.Numbers("size", 2);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (!(size[axis] >= 1.0 && size[axis] <= 1e5)) lines.Fail("a size in pixels", fmt::format("{}", size[axis]));
    view.image_size[axis] = static_cast<int>(size[axis]);
  }
  lines.Next("animated");
  const std::vector<double> intrinsic = lines.Numbers("intrinsic", 16);
  if (!(intrinsic[0] > 1.0) || !(intrinsic[5] > 1.0)) lines.Fail("focal lengths in pixels", "others");
  view.camera.K << intrinsic[0], intrinsic[1], intrinsic[2], 0.0, intrinsic[5], intrinsic[6], 0.0, 0.0, 1.0;
  const std::vector<double> extrinsic = lines.Numbers("extrinsic", 16);
  for (int r = 0; r < 3; ++r) {
    const auto row = static_cast<std::size_t>(4 * r);
    for (int c = 0; c < 3; ++c)
      view.camera.camera_from_world_rotation(r, c) = extrinsic[row + static_cast<std::size_t>(c)];
    view.camera.camera_from_world_translation[r] = extrinsic[row + 3];
  }
  const Eigen::Matrix3d& R = view.camera.camera_from_world_rotation;
  constexpr double kTolerance = 1e-3;
  if ((R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > kTolerance || R.determinant() < 0.0) {
    lines.Fail("a rotation in the extrinsic matrix", "another matrix");
  }
  if (lines.Next("radial").find_first_not_of(" \t\r0") != std::string::npos) {
    LogWarning("camera {} has radial distortion, which the imported calibration leaves out", index);
  }
  return view;
}

std::vector<CalibratedView> ReadTrainRig(const fs::path& path) {
  Lines lines(path);
  lines.Next("");
  std::vector<CalibratedView> rig;
  for (std::size_t i = 0; i < kTrainCameras; ++i) rig.push_back(ReadView(lines, i));
  return rig;
}

// ----------------------------------------------------------------------------------------------------- annotations

/// The last folder whose name is `letters` and a number, "Seq2"; empty if there is none.
std::string FindFolder(const fs::path& path, const std::string& letters) {
  std::string found;
  for (const fs::path& part : fs::absolute(path).parent_path()) {
    const std::string name = part.string();
    const bool fits = name.size() > letters.size() && name.starts_with(letters) &&
                      std::all_of(name.begin() + static_cast<std::ptrdiff_t>(letters.size()), name.end(),
                                  [](unsigned char c) { return std::isdigit(c) != 0; });
    if (fits) found = name;
  }
  return found;
}

/// The cells of a variable, with `axes` numbers per joint.
std::vector<Matrix> ReadAnnotation(const MatFile& file, const std::string& name, std::size_t axes,
                                   const fs::path& path) {
  std::vector<Matrix> cells = file.ReadCells(name, kTrainCameras);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::string place = fmt::format("{}{{{}}}", name, i + 1);
    const Matrix& cell = cells[i];
    if (cell.columns != axes * kTrainJoints || cell.rows != cells.front().rows || cell.rows == 0) {
      file.Fail(place,
                fmt::format("{} = frames, {} numbers for each of 28 joints",
                            i == 0 ? fmt::format("(N, {})", axes * kTrainJoints)
                                   : fmt::format("({}, {})", cells.front().rows, axes * kTrainJoints),
                            axes),
                fmt::format("({}, {})", cell.rows, cell.columns), kTrainSetAdvice);
    }
    RequireFiniteOrMissing(cell.values, kTrainJoints, axes, path.string(), place);
  }
  return cells;
}

class TrainSetImporter {
 public:
  explicit TrainSetImporter(const BenchmarkOptions& options)
      : options_(options),
        files_(FindFiles("annot.mat", options.paths)),
        truth_(options.truth.empty() ? "annot3" : options.truth) {
    if (options.calibration.empty()) return;
    if (files_.size() > 1) {
      ThrowInvalidArgument("`calibration` belongs to one sequence, but {} files are given; import them one by one",
                           files_.size());
    }
    rig_ = ReadTrainRig(options.calibration);
  }

  Dataset Run() {
    const Skeleton& layout = BenchmarkLayout("3dhp-28");
    const bool is_native = options_.skeleton == "native";
    BenchmarkOptions options = options_;
    // "native" means the 17 joints of the test set, on which models are compared.
    if (is_native) options.skeleton.clear();
    BenchmarkBuilder builder(options, layout, layout, is_native ? "3dhp-17" : "h36m-17");
    for (const fs::path& path : files_) builder.Add(ReadSequence(path), path);
    LogInfo("truth is {}{}; the annotations have no confidences: all are 1", truth_,
            truth_ == "annot3" ? ", the original poses (set `truth` to univ_annot3 for poses scaled to one height)"
                               : ", poses scaled to one height (set `truth` to annot3 for the original poses)");
    sides_.Warn();
    return builder.Finish();
  }

 private:
  Sequence ReadSequence(const fs::path& path) {
    if (h5::File::IsHdf5(path)) {
      ThrowBadInput({path.string(), "", "a MATLAB file of version 5", "one of version 7.3, which is HDF5",
                     "annot_data.mat of the test set is read by import 3dhp-test"});
    }
    const MatFile file(path, kTrainSetAdvice);
    std::vector<Matrix> keypoints = ReadAnnotation(file, "annot2", 2, path);
    std::vector<Matrix> poses = ReadAnnotation(file, truth_, 3, path);
    const std::size_t frames = keypoints.front().rows;
    if (poses.front().rows != frames) {
      file.Fail(truth_, fmt::format("{} frames as in annot2", frames), fmt::format("{}", poses.front().rows));
    }
    Sequence sequence;
    const std::string subject = FindFolder(path, "S");
    const std::string part = FindFolder(path, "Seq");
    sequence.subject = subject.empty() ? path.stem().string() : subject;
    sequence.name = part.empty() ? sequence.subject : fmt::format("{} {}", sequence.subject, part);
    sequence.capture = sequence.name;  // each has its own calibration
    sequence.fps = options_.fps;
    sequence.truth_kind = truth_;
    sequence.frame_count = static_cast<int>(frames);
    const double mm = Scale(poses.front(), path);
    std::vector<double> errors_px;
    for (std::size_t c = 0; c < kTrainCameras; ++c) {
      RequirePixels(keypoints[c].values, path.string(), fmt::format("annot2{{{}}}", c + 1));
      CameraView view;
      view.name = fmt::format("{}", c);
      view.image_size = rig_ ? (*rig_)[c].image_size : kTrainImageSize;
      view.confidence.assign(frames * kTrainJoints, 1.0F);
      MarkMissing(keypoints[c].values, view.confidence);
      view.keypoints = ToFloats(keypoints[c].values);
      view.truth = TruthPoses(BenchmarkLayout("3dhp-28"), ToFloats(poses[c].values, mm), view.name);
      if (rig_) {
        view.calibration = {(*rig_)[c].camera};
        errors_px.push_back(MedianProjectionError(view, view.calibration.front()));
      }
      sequence.cameras.push_back(std::move(view));
    }
    sides_.Add(CheckSides(BenchmarkLayout("3dhp-28"), sequence.cameras.front().truth.positions()), sequence.name);
    if (rig_) ReportErrors(std::move(errors_px));
    return sequence;
  }

  double Scale(const Matrix& poses, const fs::path& path) {
    const PoseUnit unit = DetectUnit(BenchmarkLayout("3dhp-28"), ToFloats(poses.values), path.string(), truth_);
    ReportUnit(unit, fmt::format("{}: {}", path.string(), truth_));
    return unit.mm_per_unit;
  }

  void ReportErrors(std::vector<double> errors_px) {
    const double median_px = Median(std::move(errors_px));
    LogInfo("projected truth is {:.2f} px from annot2 (median)", median_px);
    if (truth_ == "annot3" && median_px > kFarFromAnnot2Px) {
      LogWarning("that is a large error: check that the calibration belongs to this sequence");
    }
  }

  const BenchmarkOptions& options_;
  std::vector<fs::path> files_;
  std::string truth_;
  std::optional<std::vector<CalibratedView>> rig_;
  SideReport sides_;
};

}  // namespace

Dataset ImportMpi3dhpTrain(const BenchmarkOptions& options) { return TrainSetImporter(options).Run(); }

}  // namespace canonpose
