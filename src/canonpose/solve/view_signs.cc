#include "canonpose/solve/view_signs.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "canonpose/base/median.h"
#include "canonpose/solve/fit.h"
#include "canonpose/solve/initialisation.h"

namespace canonpose {
namespace {

constexpr int kMeasuredFrames = 300;
constexpr double kWindowSeconds = 0.5;
constexpr int kMinWindowFrames = 5;
constexpr double kOutlyingScatters = 5.0;
constexpr int kMinStepFrames = 12;
constexpr double kMinStepShare = 0.15;
// Measured by experiments/damaged on good captures and on captures that were damaged.
constexpr double kAlarmingDisagreement = 0.012;
constexpr double kAlarmingWindow = 0.05;
/// Good captures: up to 0.004. A camera of the real recording that was pushed by 4 % of its image: 0.011 to 0.019.
constexpr double kAlarmingStep = 0.008;
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

/// What a view's keypoints show in one frame.
struct FrameSigns {
  std::vector<double> errors;
  Eigen::Vector2d displacement = Eigen::Vector2d::Zero();  ///< mean of joints less keypoints, as far as they are known
  std::int64_t outliers = 0;
};

FrameSigns SignsOfFrame(const CaptureObservations& capture, const Solution& solution, int frame, int view) {
  FrameSigns signs;
  const CameraEstimate& camera = solution.estimate.CameraAt(frame, view);
  if (!camera.valid) return signs;
  const int left_out = solution.estimate.ValidViews(frame).size() > 2 ? view : -1;
  for (int j = 0; j < capture.joint_count(); ++j) {
    if (!capture.Sees(frame, view, j)) continue;
    const double usual = solution.scales.observation.Scatter(j, capture.confidence[capture.Index(frame, view, j)]);
    const auto displacement_of = [&](int without) -> Eigen::Vector2d {
      const RobustPoint joint = TriangulateJoint(capture, frame, j, solution.scales, solution.estimate, without);
      const Eigen::Vector3d in_camera = solution.estimate.InCamera(frame, view, joint.point);
      if (!joint.point.allFinite() || !(in_camera.z() > 0.0)) return Eigen::Vector2d::Constant(std::nan(""));
      const double share = without < 0 ? 1.0 : OwnShare(joint, camera.Rotation(), in_camera, usual);
      return share * DisplacementAtDepth(in_camera, camera.Focal(), capture.At(frame, view, j));
    };
    const Eigen::Vector2d displacement = displacement_of(left_out);
    if (!displacement.allFinite()) continue;
    signs.errors.push_back(displacement.norm());
    signs.displacement += (displacement - signs.displacement) / static_cast<double>(signs.errors.size());
    if (displacement_of(-1).norm() > kOutlyingScatters * usual) ++signs.outliers;
  }
  return signs;
}

/// How far the mean displacement of a clip's later frames is from that of the earlier ones, where it is farthest.
double LargestStep(const std::vector<Eigen::Vector2d>& displacements) {
  const auto count = static_cast<std::ptrdiff_t>(displacements.size());
  const std::ptrdiff_t least = std::max<std::ptrdiff_t>(kMinStepFrames, std::lround(kMinStepShare * count));
  Eigen::Vector2d after = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& displacement : displacements) after += displacement;
  Eigen::Vector2d before = Eigen::Vector2d::Zero();
  double largest = 0.0;
  for (std::ptrdiff_t n = 1; n + least <= count; ++n) {
    before += displacements[static_cast<std::size_t>(n - 1)];
    after -= displacements[static_cast<std::size_t>(n - 1)];
    if (n < least) continue;
    largest = std::max(largest, (after / static_cast<double>(count - n) - before / static_cast<double>(n)).norm());
  }
  return largest;
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
    std::vector<Eigen::Vector2d> displacements;
    for (int n = clip.first; n < clip.first + clip.count; n += step) {
      const FrameSigns frame = SignsOfFrame(capture, solution, n, view);
      outliers += frame.outliers;
      if (frame.errors.size() < 4) continue;
      all.insert(all.end(), frame.errors.begin(), frame.errors.end());
      displacements.push_back(frame.displacement);
      recent.push_back(Median(frame.errors));
      if (recent.size() < window) continue;
      const auto begin = recent.end() - static_cast<std::ptrdiff_t>(window);
      signs.worst_window = std::max(signs.worst_window, Median({begin, recent.end()}));
    }
    if (capture.static_cameras) signs.largest_step = std::max(signs.largest_step, LargestStep(displacements));
  }
  if (all.empty()) return signs;
  signs.known = true;
  signs.outliers = static_cast<double>(outliers) / static_cast<double>(all.size());
  signs.disagreement = Median(std::move(all));
  return signs;
}

}  // namespace

bool ViewSigns::Alarm() const {
  return known && (disagreement > kAlarmingDisagreement || worst_window > kAlarmingWindow ||
                   largest_step > kAlarmingStep || outliers > kAlarmingOutliers);
}

std::vector<ViewSigns> MeasureSigns(const CaptureObservations& capture, const Solution& solution) {
  std::vector<ViewSigns> signs;
  for (int v = 0; v < capture.view_count(); ++v) signs.push_back(SignsOf(capture, solution, v));
  return signs;
}

std::vector<int> KnownViews(const std::vector<ViewSigns>& signs) {
  std::vector<int> known;
  for (std::size_t v = 0; v < signs.size(); ++v) {
    if (signs[v].known) known.push_back(static_cast<int>(v));
  }
  return known;
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
