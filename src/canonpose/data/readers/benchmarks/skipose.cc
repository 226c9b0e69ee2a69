#include "canonpose/data/readers/benchmarks/skipose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <system_error>
#include <tuple>
#include <utility>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/hdf5.h"
#include "canonpose/base/log.h"
#include "canonpose/base/median.h"
#include "canonpose/data/readers/benchmarks/anatomy.h"
#include "canonpose/data/readers/benchmarks/builder.h"
#include "canonpose/geometry/points.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using Matrix3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

constexpr std::size_t kSkiJoints = 17;
constexpr int kCropSize = 256;
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
/// If poses in a frame of reference project farther from 2D than this, it is not the right frame.
constexpr double kFarPx = 8.0;

/// One row of the file.
struct Row {
  int cam = 0;
  int frame = 0;
  std::vector<double> keypoints;  ///< (17, 2) pixels
  Points3d pose;                  ///< (17, 3) as in the file
  Camera camera;                  ///< its translation in the file's unit
  Eigen::Vector3d place;          ///< position of the camera, in the file's unit
};

using Key = std::pair<int, int>;  // subject, sequence

class LabelsFile {
 public:
  explicit LabelsFile(const fs::path& path) : path_(path.string()) {
    h5::File file = h5::File::OpenForReading(path);
    const h5::Group& root = file.root();
    seq_ = ReadWhole(root, "seq");
    cam_ = ReadWhole(root, "cam");
    frame_ = ReadWhole(root, "frame");
    subj_ = ReadWhole(root, "subj");
    poses_ = ReadRows(root, "3D", 3 * kSkiJoints, /*may_be_missing=*/true);
    keypoints_ = ReadRows(root, "2D", 2 * kSkiJoints, /*may_be_missing=*/true);
    intrinsic_ = ReadRows(root, "cam_intrinsic", 9);
    position_ = ReadRows(root, "cam_position", 3);
    rotation_ = ReadRows(root, "R_cam_2_world", 9);
    constexpr double kLargestFraction = 3.0;  // a joint may be outside the image, but not far
    for (const double coordinate : keypoints_) {
      if (std::isnan(coordinate) || std::abs(coordinate) <= kLargestFraction) continue;
      root.Fail("2D", "fractions of the image, 0 to 1", fmt::format("{}", coordinate), "give labels.h5 as published");
    }
  }

  [[nodiscard]] std::size_t size() const { return seq_.size(); }
  [[nodiscard]] Key KeyOf(std::size_t row) const { return {subj_[row], seq_[row]}; }

  [[nodiscard]] Row At(std::size_t i) const {
    Row row;
    row.cam = cam_[i];
    row.frame = frame_[i];
    for (std::size_t k = 0; k < 2 * kSkiJoints; ++k)
      row.keypoints.push_back(kCropSize * keypoints_[2 * kSkiJoints * i + k]);
    row.pose = Eigen::Map<const Points3d>(&poses_[3 * kSkiJoints * i], kSkiJoints, 3);
    row.place = Eigen::Map<const Eigen::Vector3d>(&position_[3 * i]);
    const Matrix3 K = Eigen::Map<const Matrix3>(&intrinsic_[9 * i]);
    const bool is_camera_matrix = K(0, 0) > 0.0 && K(1, 1) > 0.0 && std::abs(K(2, 2) - 1.0) < 1e-6 &&
                                  std::abs(K(1, 0)) < 1e-6 && std::abs(K(2, 0)) < 1e-6 && std::abs(K(2, 1)) < 1e-6;
    if (!is_camera_matrix) Fail("cam_intrinsic", i, "[[fx, s, cx], [0, fy, cy], [0, 0, 1]] with fx, fy > 0");
    row.camera.K << kCropSize * K(0, 0), kCropSize * K(0, 1), kCropSize * K(0, 2), 0.0, kCropSize * K(1, 1),
        kCropSize * K(1, 2), 0.0, 0.0, 1.0;
    const Matrix3 R = Eigen::Map<const Matrix3>(&rotation_[9 * i]);
    constexpr double kRounding = 0.01;
    if ((R * R.transpose() - Matrix3::Identity()).cwiseAbs().maxCoeff() > kRounding || R.determinant() < 0.0) {
      Fail("R_cam_2_world", i, "a rotation matrix");
    }
    const Eigen::Matrix3d camera_from_world = rotations_are_camera_from_world_ ? R : Matrix3(R.transpose());
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(camera_from_world, Eigen::ComputeFullU | Eigen::ComputeFullV);
    row.camera.camera_from_world_rotation = svd.matrixU() * svd.matrixV().transpose();
    row.camera.camera_from_world_translation = -(row.camera.camera_from_world_rotation * row.place);
    return row;
  }

  [[nodiscard]] const std::vector<double>& poses() const { return poses_; }
  [[nodiscard]] const std::string& path() const { return path_; }

  /// From now on, R_cam_2_world is used as camera_from_world, despite its name.
  void InvertRotations() { rotations_are_camera_from_world_ = !rotations_are_camera_from_world_; }

  /// Swaps the joints of the left and the right leg.
  void SwapLegs() {
    for (std::size_t i = 0; i < size(); ++i) {
      for (std::size_t joint = 1; joint <= 3; ++joint) {
        std::swap_ranges(&poses_[3 * (i * kSkiJoints + joint)], &poses_[3 * (i * kSkiJoints + joint)] + 3,
                         &poses_[3 * (i * kSkiJoints + joint + 3)]);
        std::swap_ranges(&keypoints_[2 * (i * kSkiJoints + joint)], &keypoints_[2 * (i * kSkiJoints + joint)] + 2,
                         &keypoints_[2 * (i * kSkiJoints + joint + 3)]);
      }
    }
  }

 private:
  [[noreturn]] void Fail(const std::string& name, std::size_t row, const std::string& expected) const {
    ThrowBadInput(
        {path_, fmt::format("/{}, row {}", name, row), expected, "another matrix", "give labels.h5 as published"});
  }

  /// Reads an array with one row per view and any further dimensions. `may_be_missing`: values may be NaN.
  std::vector<double> ReadRows(const h5::Group& root, const std::string& name, std::size_t columns,
                               bool may_be_missing = false) const {
    if (!root.Has(name)) root.Fail(name, "an array", "nothing", "give labels.h5 of Ski-PosePTZ");
    h5::Array<double> array = ReadNumbers(root, name);
    const std::size_t rows = seq_.empty() ? (array.shape.empty() ? 0 : array.shape.front()) : seq_.size();
    if (rows == 0 || array.shape.empty() || array.shape.front() != rows || array.values.size() != rows * columns) {
      root.Fail(
          name,
          fmt::format("shape ({}, {}) = views, numbers per view", rows == 0 ? "N" : fmt::format("{}", rows), columns),
          h5::FormatShape(array.shape), "give labels.h5 of Ski-PosePTZ as published");
    }
    const auto require = may_be_missing ? RequireFiniteOrMissing : RequireFinite;
    require(array.values, columns, 1, path_, "/" + name);
    return std::move(array.values);
  }

  std::vector<int> ReadWhole(const h5::Group& root, const std::string& name) const {
    std::vector<int> whole;
    for (const double value : ReadRows(root, name, 1)) {
      constexpr double kLargest = 1e9;
      if (!(value >= 0.0 && value <= kLargest) || value != std::trunc(value)) {
        ThrowBadInput(
            {path_, "/" + name, "whole numbers from 0 on", fmt::format("{}", value), "give labels.h5 as published"});
      }
      whole.push_back(static_cast<int>(value));
    }
    return whole;
  }

  std::string path_;
  std::vector<int> seq_;
  std::vector<int> cam_;
  std::vector<int> frame_;
  std::vector<int> subj_;
  std::vector<double> poses_;
  std::vector<double> keypoints_;
  std::vector<double> intrinsic_;
  std::vector<double> position_;
  std::vector<double> rotation_;
  bool rotations_are_camera_from_world_ = false;
};

// ------------------------------------------------------------------------------------------- the frame of the poses

/// A frame that 3D may be in.
struct Frame {
  const char* description;
  bool is_world;   ///< otherwise the camera's
  bool has_place;  ///< whether it includes the person's position, which is otherwise found from 2D
};

constexpr std::array<Frame, 4> kFrames = {
    {{"the camera's frame", false, true},
     {"the camera's frame relative to the person, whose position is found from 2D", false, false},
     {"the world's frame", true, true},
     {"the world's axes relative to the person, whose position is found from 2D", true, false}}};

/// The translation (a, b, c) with which points project nearest to the pixels, by least squares: u (z + c) = x + a and v
/// (z + c) = y + b for each joint that is known in both. NaN where these are too few.
Eigen::Vector3d FindPlace(const Points3d& points, const Row& row) {
  constexpr int kFewestJoints = 3;
  const auto joints = static_cast<Eigen::Index>(kSkiJoints);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * joints, 3);  // rows of unknown joints stay 0
  Eigen::VectorXd b = Eigen::VectorXd::Zero(2 * joints);
  const Eigen::Matrix3d K_inverse = row.camera.K.inverse();
  int known = 0;
  for (Eigen::Index j = 0; j < joints; ++j) {
    const auto at = static_cast<std::size_t>(2 * j);
    if (!points.row(j).allFinite() || std::isnan(row.keypoints[at]) || std::isnan(row.keypoints[at + 1])) continue;
    ++known;
    const Eigen::Vector3d ray = K_inverse * Eigen::Vector3d(row.keypoints[at], row.keypoints[at + 1], 1.0);
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      A(2 * j + axis, axis) = 1.0;
      A(2 * j + axis, 2) = -ray[axis];
      b[2 * j + axis] = ray[axis] * points(j, 2) - points(j, axis);
    }
  }
  if (known < kFewestJoints) return Eigen::Vector3d::Constant(std::nan(""));
  return A.colPivHouseholderQr().solve(b);
}

/// The pose of a row in its camera's frame and in the file's unit, assuming that 3D is in `frame`.
Points3d InCamera(const Row& row, const Frame& frame) {
  Points3d points = row.pose;
  if (frame.is_world) {
    const Eigen::Vector3d origin = frame.has_place ? row.place : Eigen::Vector3d::Zero();
    points = (points.rowwise() - origin.transpose()) * row.camera.camera_from_world_rotation.transpose();
  }
  if (!frame.has_place) points.rowwise() += FindPlace(points, row).transpose();
  return points;
}

/// NaN where no joint is known in both.
double ErrorPx(const Row& row, const Points3d& points) {
  std::vector<double> distances;
  for (Eigen::Index j = 0; j < points.rows(); ++j) {
    const auto at = static_cast<std::size_t>(2 * j);
    if (!points.row(j).allFinite() || std::isnan(row.keypoints[at]) || std::isnan(row.keypoints[at + 1])) continue;
    const Eigen::Vector3d pixel = row.camera.K * points.row(j).transpose();
    const bool is_before = points(j, 2) > 0.0;
    distances.push_back(
        is_before ? std::hypot(pixel.x() / pixel.z() - row.keypoints[at], pixel.y() / pixel.z() - row.keypoints[at + 1])
                  : 1e6);
  }
  return Median(std::move(distances));
}

const Frame& DetectFrame(const LabelsFile& file) {
  constexpr std::size_t kEnough = 200;
  const std::size_t stride = std::max<std::size_t>(1, file.size() / kEnough);
  std::array<double, kFrames.size()> errors_px{};
  for (std::size_t f = 0; f < kFrames.size(); ++f) {
    std::vector<double> errors;
    for (std::size_t i = 0; i < file.size(); i += stride) {
      const Row row = file.At(i);
      const double error_px = ErrorPx(row, InCamera(row, kFrames[f]));
      if (!std::isnan(error_px)) errors.push_back(error_px);
    }
    errors_px[f] = Median(std::move(errors));
  }
  // A position that is found from 2D always fits at least as well as a known one.
  std::size_t best = 0;
  constexpr double kClearlyBetterPx = 1.0;
  for (std::size_t f = 1; f < kFrames.size(); ++f) {
    if (errors_px[f] + kClearlyBetterPx < errors_px[best]) best = f;
  }
  if (errors_px[best] > kFarPx) {
    best = 1;
    LogWarning(
        "{}: 3D does not project to 2D in any frame; it is assumed to be in {} ({:.1f} px off), as loaders of this "
        "benchmark do",
        file.path(), kFrames[best].description, errors_px[best]);
  } else {
    LogInfo("{}: 3D is in {}, where it projects to within {:.2f} px of 2D (median)", file.path(),
            kFrames[best].description, errors_px[best]);
  }
  return kFrames[best];
}

/// Median distance, in the file's unit, between the same root-centred joint from two cameras of one frame, in the
/// world; NaN if no frame has two cameras. Poses are in their cameras' frames.
double DisagreementInWorld(const LabelsFile& file) {
  std::map<std::tuple<int, int, int>, Points3d> first;  // by subject, sequence and frame
  std::vector<double> distances;
  for (std::size_t i = 0; i < file.size(); ++i) {
    const Row row = file.At(i);
    const auto [subject, sequence] = file.KeyOf(i);
    const Points3d about_root = row.pose.rowwise() - row.pose.row(0);
    const Points3d in_world = about_root * row.camera.camera_from_world_rotation;
    const auto [other, is_first] = first.emplace(std::tuple(subject, sequence, row.frame), in_world);
    if (is_first) continue;
    for (Eigen::Index j = 1; j < in_world.rows(); ++j) {
      const double distance = (in_world.row(j) - other->second.row(j)).norm();
      if (!std::isnan(distance)) distances.push_back(distance);
    }
  }
  return distances.empty() ? std::nan("") : Median(std::move(distances));
}

/// Poses in the cameras' frames only allow checking the cameras' rotations where two cameras see the same frame.
void CheckRotations(LabelsFile& file, double mm) {
  constexpr double kAgreeMm = 100.0;
  const double apart_mm = mm * DisagreementInWorld(file);
  if (std::isnan(apart_mm)) return;
  if (apart_mm <= kAgreeMm) {
    LogInfo("{}: with R_cam_2_world, the same joint differs between cameras by {:.1f} mm in the world (median)",
            file.path(), apart_mm);
    return;
  }
  file.InvertRotations();
  const double inverted_mm = mm * DisagreementInWorld(file);
  if (inverted_mm <= kAgreeMm) {
    LogWarning(
        "{}: R_cam_2_world is inverted, since it actually leads from the world to the camera: so used, the same joint "
        "differs between cameras by {:.1f} mm, otherwise by {:.0f} mm",
        file.path(), inverted_mm, apart_mm);
    return;
  }
  file.InvertRotations();
  LogWarning(
      "{}: with R_cam_2_world, the same joint differs between cameras by {:.0f} mm in the world: do not trust a "
      "triangulation, or preset epipolar, which learns from it; nothing else uses the rotations",
      file.path(), apart_mm);
}

// --------------------------------------------------------------------------------------------------------- sequences

std::vector<fs::path> FindFiles(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return {path};
  if (fs::exists(path / "labels.h5", error)) return {path / "labels.h5"};
  std::vector<fs::path> files;
  for (const char* const split : {"train", "test"}) {
    if (fs::exists(path / split / "labels.h5", error)) files.push_back(path / split / "labels.h5");
  }
  if (files.empty()) {
    ThrowBadInput({path.string(), "", "labels.h5, or train/labels.h5 and test/labels.h5", "neither", "check the path"});
  }
  return files;
}

/// Views of one camera in the order of `frames`. A missing view gets only the calibration of the nearest one.
CameraView MakeView(int cam, const std::map<int, Row>& rows, const std::vector<int>& frames, const Frame& frame,
                    double mm) {
  CameraView view;
  view.name = fmt::format("cam_{:02d}", cam);
  view.image_size = {kCropSize, kCropSize};
  std::vector<float> truth;
  for (const int number : frames) {
    auto nearest = rows.lower_bound(number);
    if (nearest == rows.end()) nearest = std::prev(nearest);
    Camera camera = nearest->second.camera;
    camera.camera_from_world_translation *= mm;
    view.calibration.push_back(camera);
    const bool is_seen = nearest->first == number;
    const Points3d points =
        is_seen ? InCamera(nearest->second, frame) : Points3d::Constant(kSkiJoints, 3, std::nan(""));
    std::vector<double> keypoints(2 * kSkiJoints, kUnknown);
    if (is_seen) keypoints = nearest->second.keypoints;
    std::vector<float> confidence(kSkiJoints, 1.0F);
    MarkMissing(keypoints, confidence);
    for (const double coordinate : keypoints) view.keypoints.push_back(static_cast<float>(coordinate));
    view.confidence.insert(view.confidence.end(), confidence.begin(), confidence.end());
    for (Eigen::Index i = 0; i < points.size(); ++i) truth.push_back(static_cast<float>(mm * points.data()[i]));
  }
  view.truth = TruthPoses(BenchmarkLayout("h36m-17"), std::move(truth), view.name);
  return view;
}

class SkiPoseImporter {
 public:
  explicit SkiPoseImporter(const BenchmarkOptions& options) : options_(options) {}

  Dataset Run() {
    std::vector<fs::path> files;
    for (const fs::path& path : options_.paths) {
      for (fs::path& file : FindFiles(path)) files.push_back(std::move(file));
    }
    if (files.size() > 1) {
      LogWarning("several files become one dataset; to train on train and evaluate on test, import them one by one");
    }
    const Skeleton& layout = BenchmarkLayout("h36m-17");
    BenchmarkBuilder builder(options_, layout, layout, "h36m-17");
    for (const fs::path& path : files) AddFile(path, builder);
    LogInfo("images are {0}x{0}; the annotations have no confidences: all are 1; the cameras move", kCropSize);
    return builder.Finish();
  }

 private:
  void AddFile(const fs::path& path, BenchmarkBuilder& builder) {
    LabelsFile file(path);
    const Skeleton& layout = BenchmarkLayout("h36m-17");
    const std::vector<float> poses = ToFloats(file.poses());
    const PoseUnit unit = DetectUnit(layout, poses, path.string(), "/3D");
    LogInfo("{}: 3D is in {}, since legs are {:.0f} mm long", path.string(), unit.name, unit.leg_mm);
    const Frame& frame = DetectFrame(file);
    if (!frame.is_world) CheckRotations(file, unit.mm_per_unit);
    RenameLegs(file, frame);
    std::map<Key, std::map<int, std::map<int, Row>>> sequences;  // by camera and frame
    for (std::size_t i = 0; i < file.size(); ++i) {
      Row row = file.At(i);
      const Key key = file.KeyOf(i);
      const int cam = row.cam;
      const int number = row.frame;
      if (!sequences[key][cam].emplace(number, std::move(row)).second) {
        ThrowBadInput({path.string(), fmt::format("row {}", i), "each view once",
                       fmt::format("subject {}, seq {}, cam {}, frame {} again", key.first, key.second, cam, number),
                       "give labels.h5 as published"});
      }
    }
    for (const auto& [key, cameras] : sequences) builder.Add(MakeSequence(key, cameras, frame, unit), path);
  }

  Sequence MakeSequence(const Key& key, const std::map<int, std::map<int, Row>>& cameras, const Frame& frame,
                        const PoseUnit& unit) {
    std::set<int> numbers;
    std::size_t views = 0;
    for (const auto& [cam, rows] : cameras) {
      views += rows.size();
      for (const auto& [number, row] : rows) numbers.insert(number);
    }
    Sequence sequence;
    sequence.subject = fmt::format("S{}", key.first);
    sequence.name = sequence.capture = fmt::format("S{} seq_{:03d}", key.first, key.second);
    sequence.static_cameras = false;
    sequence.fps = options_.fps;
    sequence.actions = {"Skiing"};
    sequence.frame_count = static_cast<int>(numbers.size());
    const std::vector<int> frames(numbers.begin(), numbers.end());
    for (const auto& [cam, rows] : cameras)
      sequence.cameras.push_back(MakeView(cam, rows, frames, frame, unit.mm_per_unit));
    const std::size_t missing = cameras.size() * frames.size() - views;
    if (missing > 0) LogInfo("{}: {} of {} views are not in the file", sequence.name, missing, missing + views);
    return sequence;
  }

  void RenameLegs(LabelsFile& file, const Frame& frame) {
    std::vector<float> poses;
    for (std::size_t i = 0; i < file.size(); ++i) {
      const Points3d points = InCamera(file.At(i), frame);
      for (Eigen::Index k = 0; k < points.size(); ++k) poses.push_back(static_cast<float>(points.data()[k]));
    }
    const SideCheck sides = CheckSides(BenchmarkLayout("h36m-17"), poses);
    if (!sides.measured) {
      LogWarning("{}: the poses do not show whether left and right are named correctly", file.path());
    } else if (sides.legs_swapped && !sides.arms_swapped) {
      LogWarning("{}: the left and right legs have each other's names, or knees bend backwards; renamed", file.path());
      file.SwapLegs();
    } else if (sides.arms_swapped) {
      SideReport report;
      report.Add(sides, file.path());
      report.Warn();
    } else {
      LogInfo("{}: left and right are named correctly, judging by knees and noses", file.path());
    }
  }

  const BenchmarkOptions& options_;
};

}  // namespace

Dataset ImportSkiPose(const BenchmarkOptions& options) { return SkiPoseImporter(options).Run(); }

}  // namespace canonpose
