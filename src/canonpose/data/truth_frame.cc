#include "canonpose/data/truth_frame.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/median.h"
#include "canonpose/geometry/angles.h"

namespace canonpose {
namespace {

constexpr int kTruthFrames = 60;
constexpr std::size_t kFewestComparedJoints = 5;
constexpr int kFitIterations = 8;
/// Truth in the camera's frame is far below this: detectors err by a few percent, and without the distance of the
/// person, so that perspective cannot be computed, the misfit is up to 0.2.
constexpr double kContradicts = 0.4;
/// Another frame is believed where the misfit in it is small, and that much smaller.
constexpr double kFits = 0.2;
constexpr double kMuchBetter = 0.4;
/// A person away from the image centre looks rotated by up to half the field of view.
constexpr double kSmallestRotationDeg = 40.0;

/// The joints that both keypoints and truth have in one frame, the root first.
struct Observed {
  Eigen::Matrix2Xd pixels;
  Eigen::Matrix3Xd truth;
  int frame = 0;
};

std::optional<Observed> Observe(const CameraView& view, int frame, const Skeleton& skeleton) {
  const std::size_t joints = skeleton.joints.size();
  const std::size_t offset = static_cast<std::size_t>(frame) * joints;
  std::vector<std::size_t> seen;
  for (std::size_t j = 0; j < joints; ++j) {
    const bool is_known = view.confidence[offset + j] > 0.0F && view.truth.IsKnown(frame, static_cast<int>(j));
    if (is_known && static_cast<int>(j) == skeleton.root) {
      seen.insert(seen.begin(), j);
    } else if (is_known) {
      seen.push_back(j);
    }
  }
  if (seen.size() < kFewestComparedJoints || static_cast<int>(seen.front()) != skeleton.root) return std::nullopt;
  Observed observed{Eigen::Matrix2Xd(2, seen.size()), Eigen::Matrix3Xd(3, seen.size()), frame};
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const float* pixel = &view.keypoints[2 * (offset + seen[i])];
    const auto column = static_cast<Eigen::Index>(i);
    observed.pixels.col(column) = Eigen::Vector2d(pixel[0], pixel[1]);
    observed.truth.col(column) =
        view.truth.PoseAt(frame).row(static_cast<Eigen::Index>(seen[i])).transpose().cast<double>();
  }
  return observed;
}

/// Centred on the first column, of norm 1.
template <typename Points>
Points Normalised(const Points& points) {
  Points centred = points.colwise() - points.col(0).eval();
  const double norm = centred.norm();
  if (norm > 0.0) centred /= norm;
  return centred;
}

double Misfit(const Eigen::Matrix2Xd& pixels, const Eigen::Matrix2Xd& projected) {
  return (Normalised(pixels) - Normalised(projected)).norm();
}

/// With perspective where the points lie in front of the camera, without it where that fits better.
double MisfitInCamera(const Eigen::Matrix2Xd& pixels, const Eigen::Matrix3Xd& points) {
  const double flat = Misfit(pixels, points.topRows<2>());
  if (!(points.row(2).minCoeff() > 0.0)) return flat;
  return std::min(flat, Misfit(pixels, points.colwise().hnormalized()));
}

double MedianMisfit(const std::vector<Observed>& frames, const std::function<double(const Observed&)>& misfit) {
  std::vector<double> misfits;
  for (const Observed& frame : frames) misfits.push_back(misfit(frame));
  return Median(std::move(misfits));
}

/// The rotation of all frames' truth that fits the keypoints best under weak perspective: least squares without the
/// constraint, then the nearest rotation, with each pose scaled anew to what the last rotation shows of it.
Eigen::Matrix3d FitRotation(const std::vector<Observed>& frames) {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  std::vector<double> scales(frames.size(), 1.0);
  for (int iteration = 0; iteration < kFitIterations; ++iteration) {
    Eigen::Matrix3d squares = 1e-9 * Eigen::Matrix3d::Identity();
    Eigen::Matrix<double, 2, 3> products = Eigen::Matrix<double, 2, 3>::Zero();
    for (std::size_t f = 0; f < frames.size(); ++f) {
      const Eigen::Matrix3Xd truth = scales[f] * Normalised(frames[f].truth);
      squares += truth * truth.transpose();
      products += Normalised(frames[f].pixels) * truth.transpose();
    }
    const Eigen::Matrix<double, 2, 3> free = products * squares.inverse();
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(free, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::Matrix<double, 2, 3> rows = svd.matrixU() * svd.matrixV().transpose();
    rotation.topRows<2>() = rows;
    rotation.row(2) = rows.row(0).cross(rows.row(1));
    for (std::size_t f = 0; f < frames.size(); ++f) {
      const double shown = (rows * Normalised(frames[f].truth)).norm();
      if (shown > 0.0) scales[f] = 1.0 / shown;
    }
  }
  return rotation;
}

bool IsBelieved(double misfit, double other) {
  return misfit > kContradicts && other < kFits && other < kMuchBetter * misfit;
}

}  // namespace

bool TruthFrame::is_in_world() const { return IsBelieved(misfit, misfit_from_world); }

bool TruthFrame::is_rotated() const {
  return IsBelieved(misfit, misfit_rotated) && rotation_deg > kSmallestRotationDeg;
}

TruthFrame MeasureTruthFrame(const CameraView& view, int frame_count, const Skeleton& skeleton) {
  constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();
  TruthFrame result{kNotMeasured, kNotMeasured, kNotMeasured, 0.0};
  if (view.truth.empty()) return result;
  std::vector<Observed> frames;
  const int step = std::max(1, frame_count / kTruthFrames);
  for (int frame = 0; frame < frame_count; frame += step) {
    if (const std::optional<Observed> observed = Observe(view, frame, skeleton)) frames.push_back(*observed);
  }
  if (frames.empty()) return result;
  result.misfit = MedianMisfit(frames, [](const Observed& frame) { return MisfitInCamera(frame.pixels, frame.truth); });
  if (!view.calibration.empty()) {
    result.misfit_from_world = MedianMisfit(frames, [&](const Observed& frame) {
      const Camera& camera = view.CalibrationAt(frame.frame);
      const Eigen::Matrix3Xd in_camera =
          (camera.camera_from_world_rotation * frame.truth).colwise() + camera.camera_from_world_translation;
      return MisfitInCamera(frame.pixels, in_camera);
    });
  }
  const Eigen::Matrix3d rotation = FitRotation(frames);
  result.misfit_rotated = MedianMisfit(
      frames, [&](const Observed& frame) { return Misfit(frame.pixels, (rotation * frame.truth).topRows<2>()); });
  result.rotation_deg = DegFromRad(std::acos(std::clamp((rotation.trace() - 1.0) / 2.0, -1.0, 1.0)));
  return result;
}

void RequireTruthInCameraFrame(const Dataset& dataset, const std::string& file) {
  for (const Sequence& sequence : dataset.sequences) {
    for (const CameraView& view : sequence.cameras) {
      const TruthFrame frame = MeasureTruthFrame(view, sequence.frame_count, dataset.skeleton);
      if (!frame.is_in_world() && !frame.is_rotated()) continue;
      ThrowBadInput(
          {file, fmt::format("/sequences/{}/cameras/{}/truth", sequence.name, view.name),
           "poses in the camera's frame (x right, y down, z forward)",
           frame.is_in_world()
               ? "poses in the world's, by the keypoints and the calibration"
               : fmt::format("poses in one that is rotated by {:.0f} degrees, by the keypoints", frame.rotation_deg),
           "write R x + t of the camera instead of x"});
    }
  }
}

}  // namespace canonpose
