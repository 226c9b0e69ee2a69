#include "canonpose/solve/view_signs.h"

#include <algorithm>
#include <cmath>

#include "canonpose/base/median.h"
#include "canonpose/solve/fit.h"
#include "canonpose/solve/initialisation.h"

namespace canonpose {
namespace {

constexpr int kMeasuredFrames = 300;
constexpr double kWindowSeconds = 0.5;
constexpr int kMinWindowFrames = 5;
constexpr double kOutlyingScatters = 5.0;
// Measured by experiments/damaged on good captures and on captures that were damaged.
constexpr double kAlarmingDisagreement = 0.012;
constexpr double kAlarmingWindow = 0.05;
constexpr double kAlarmingOutliers = 0.12;
/// Fewer are alarming where the other views have far fewer.
constexpr double kAlarmingAmongFew = 0.08;
constexpr double kTimesTheOthers = 2.0;

/// How much of the distance between a keypoint and a joint that other views triangulate is the keypoint's own: its
/// scatter relative to that of both together, in the view's image.
double OwnShare(const RobustPoint& joint, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& in_camera,
                double scatter) {
  const double variance = VarianceInView(rotation, in_camera, joint.information.inverse());
  return std::isfinite(variance) && variance >= 0.0 ? scatter / std::sqrt(scatter * scatter + variance) : 0.0;
}

/// Errors of a view's keypoints in one frame.
std::vector<double> FrameErrors(const CaptureObservations& capture, const Solution& solution, int frame, int view,
                                std::int64_t& outliers) {
  std::vector<double> errors;
  const CameraEstimate& camera = solution.estimate.CameraAt(frame, view);
  if (!camera.valid) return errors;
  const int left_out = solution.estimate.ValidViews(frame).size() > 2 ? view : -1;
  for (int j = 0; j < capture.joint_count(); ++j) {
    if (!capture.Sees(frame, view, j)) continue;
    const double usual = solution.scales.observation.Scatter(j, capture.confidence[capture.Index(frame, view, j)]);
    const auto error_of = [&](int without) {
      const RobustPoint joint = TriangulateJoint(capture, frame, j, solution.scales, solution.estimate, without);
      if (!joint.point.allFinite()) return std::nan("");
      const Eigen::Vector3d in_camera = solution.estimate.InCamera(frame, view, joint.point);
      const double error = DistanceInFront(in_camera, camera.Focal(), capture.At(frame, view, j));
      return without < 0 ? error : error * OwnShare(joint, camera.Rotation(), in_camera, usual);
    };
    const double error = error_of(left_out);
    if (!std::isfinite(error)) continue;
    errors.push_back(error);
    if (error_of(-1) > kOutlyingScatters * usual) ++outliers;
  }
  return errors;
}

ViewSigns SignsOf(const CaptureObservations& capture, const Solution& solution, int view) {
  ViewSigns signs;
  const int step = std::max(1, capture.frame_count / kMeasuredFrames);
  std::vector<double> all;
  std::int64_t outliers = 0;
  for (const ClipRange& clip : capture.clips) {
    const auto window =
        static_cast<std::size_t>(std::max<double>(kMinWindowFrames, std::ceil(kWindowSeconds * clip.fps / step)));
    std::vector<double> recent;  // medians of frames
    for (int n = clip.first; n < clip.first + clip.count; n += step) {
      const std::vector<double> errors = FrameErrors(capture, solution, n, view, outliers);
      if (errors.size() < 4) continue;
      all.insert(all.end(), errors.begin(), errors.end());
      recent.push_back(Median(errors));
      if (recent.size() < window) continue;
      const auto begin = recent.end() - static_cast<std::ptrdiff_t>(window);
      signs.worst_window = std::max(signs.worst_window, Median({begin, recent.end()}));
    }
  }
  if (all.empty()) return signs;
  signs.known = true;
  signs.outliers = static_cast<double>(outliers) / static_cast<double>(all.size());
  signs.disagreement = Median(std::move(all));
  return signs;
}

}  // namespace

bool ViewSigns::Alarm() const {
  return known &&
         (disagreement > kAlarmingDisagreement || worst_window > kAlarmingWindow || outliers > kAlarmingOutliers);
}

std::vector<ViewSigns> MeasureSigns(const CaptureObservations& capture, const Solution& solution) {
  std::vector<ViewSigns> signs;
  for (int v = 0; v < capture.view_count(); ++v) signs.push_back(SignsOf(capture, solution, v));
  return signs;
}

bool AnyAlarm(const std::vector<ViewSigns>& signs) {
  if (std::ranges::any_of(signs, &ViewSigns::Alarm)) return true;
  std::vector<double> outliers;
  for (const ViewSigns& view : signs) {
    if (view.known) outliers.push_back(view.outliers);
  }
  if (outliers.size() < 3) return false;
  const double most = std::ranges::max(outliers);
  return most > kAlarmingAmongFew && most > kTimesTheOthers * Median(std::move(outliers));
}

}  // namespace canonpose
