#include "canonpose/solve/factorisation.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/Dense>

#include "canonpose/base/error.h"
#include "canonpose/base/median.h"
#include "canonpose/geometry/alignment.h"
#include "canonpose/solve/diagnosis.h"
#include "canonpose/solve/frame_choice.h"
#include "canonpose/solve/metric_upgrade.h"

namespace canonpose {
namespace {

constexpr int kMinJoints = 6;
/// Cameras are found from at most this many frames, evenly spread.
constexpr int kFactorisedFrames = 600;
constexpr int kRounds = 30;

/// The affine reconstruction of some frames.
class AffineSolver {
 public:
  AffineSolver(const CaptureObservations& capture, std::vector<int> frames)
      : capture_(capture),
        frames_(std::move(frames)),
        views_(static_cast<std::size_t>(capture.view_count()), AffineView::Constant(std::nan(""))),
        joints_(frames_.size() * capture.skeleton.joints.size(), Eigen::Vector3d::Constant(std::nan(""))),
        scales_(frames_.size() * capture.cameras.size(), 1.0),
        offsets_(frames_.size() * capture.cameras.size(), Eigen::Vector2d::Zero()) {}

  /// Finds a first estimate of the views. Returns false where no two views share enough.
  bool Start();
  /// Takes the views from elsewhere, so that only the joints remain to be found.
  void StartFrom(const std::vector<AffineView>& views);
  void FindViews();
  void FindJoints();
  void FindScales();

  [[nodiscard]] const std::vector<AffineView>& views() const { return views_; }
  [[nodiscard]] const std::vector<Eigen::Vector3d>& joints() const { return joints_; }
  [[nodiscard]] std::size_t joint_count() const { return capture_.skeleton.joints.size(); }

 private:
  [[nodiscard]] bool Sees(std::size_t i, std::size_t v, std::size_t j) const {
    return capture_.Sees(frames_[i], static_cast<int>(v), static_cast<int>(j)) && views_[v].allFinite();
  }
  [[nodiscard]] Eigen::Vector2d At(std::size_t i, std::size_t v, std::size_t j) const {
    return capture_.At(frames_[i], static_cast<int>(v), static_cast<int>(j));
  }
  /// Calls visit((keypoint - offset) / scale, joint) for every known joint that a view sees.
  template <typename Visit>
  void VisitSeen(std::size_t v, const Visit& visit) const {
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      for (std::size_t j = 0; j < joint_count(); ++j) {
        const Eigen::Vector3d& joint = joints_[i * joint_count() + j];
        if (!capture_.Sees(frames_[i], static_cast<int>(v), static_cast<int>(j)) || !joint.allFinite()) continue;
        const std::size_t at = i * views_.size() + v;
        visit(Eigen::Vector2d((At(i, v, j) - offsets_[at]) / scales_[at]), joint);
      }
    }
  }
  /// The joints that all of `views` see in a frame.
  [[nodiscard]] std::vector<std::size_t> Common(std::size_t i, const std::vector<std::size_t>& views) const;
  [[nodiscard]] std::vector<std::size_t> ChooseViews() const;
  /// Makes the mean of a view's keypoints of `joints` its offset and returns their size about it.
  double Centre(std::size_t i, std::size_t v, const std::vector<std::size_t>& joints);
  /// Sets the offsets of all frames and views to the means of what is seen.
  void CentreAll();

  const CaptureObservations& capture_;
  std::vector<int> frames_;
  std::vector<AffineView> views_;         ///< (V)
  std::vector<Eigen::Vector3d> joints_;   ///< (frames, J)
  std::vector<double> scales_;            ///< (frames, V)
  std::vector<Eigen::Vector2d> offsets_;  ///< (frames, V)
};

std::vector<std::size_t> AffineSolver::Common(std::size_t i, const std::vector<std::size_t>& views) const {
  std::vector<std::size_t> common;
  for (std::size_t j = 0; j < joint_count(); ++j) {
    const bool is_seen = std::ranges::all_of(
        views, [&](std::size_t v) { return capture_.Sees(frames_[i], static_cast<int>(v), static_cast<int>(j)); });
    if (is_seen) common.push_back(j);
  }
  if (common.size() < static_cast<std::size_t>(kMinJoints)) common.clear();
  return common;
}

/// All views but those without which the others share at least twice as many frames; empty where no two share enough.
std::vector<std::size_t> AffineSolver::ChooseViews() const {
  std::vector<std::size_t> views(capture_.cameras.size());
  for (std::size_t v = 0; v < views.size(); ++v) views[v] = v;
  const auto frames_of = [&](const std::vector<std::size_t>& chosen) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < frames_.size(); ++i) count += Common(i, chosen).empty() ? 0 : 1;
    return count;
  };
  std::size_t count = frames_of(views);
  while (views.size() > 2) {
    std::size_t best = count;
    std::size_t worst_view = views.size();
    for (std::size_t k = 0; k < views.size(); ++k) {
      std::vector<std::size_t> others = views;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
      const std::size_t frames = frames_of(others);
      if (frames > best) {
        best = frames;
        worst_view = k;
      }
    }
    if (worst_view == views.size() || best < 2 * count) break;
    views.erase(views.begin() + static_cast<std::ptrdiff_t>(worst_view));
    count = best;
  }
  if (count < static_cast<std::size_t>(kMinFrames) || views.size() < 2) views.clear();
  return views;
}

double AffineSolver::Centre(std::size_t i, std::size_t v, const std::vector<std::size_t>& joints) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const std::size_t j : joints) mean += At(i, v, j) / static_cast<double>(joints.size());
  double squares = 0.0;
  for (const std::size_t j : joints) squares += (At(i, v, j) - mean).squaredNorm();
  offsets_[i * views_.size() + v] = mean;
  return std::sqrt(squares);
}

bool AffineSolver::Start() {
  const std::vector<std::size_t> chosen = ChooseViews();
  if (chosen.empty()) return false;
  // Left singular vectors of the keypoints of all frames, each frame divided by the mean size of its views.
  const auto rows = static_cast<Eigen::Index>(2 * chosen.size());
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(rows, rows);
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    const std::vector<std::size_t> common = Common(i, chosen);
    if (common.empty()) continue;
    double size = 0.0;
    for (const std::size_t v : chosen) size += Centre(i, v, common) / static_cast<double>(chosen.size());
    if (!(size > 0.0)) continue;
    Eigen::MatrixXd keypoints(rows, static_cast<Eigen::Index>(common.size()));
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      for (std::size_t c = 0; c < common.size(); ++c) {
        keypoints.block<2, 1>(static_cast<Eigen::Index>(2 * k), static_cast<Eigen::Index>(c)) =
            (At(i, chosen[k], common[c]) - offsets_[i * views_.size() + chosen[k]]) / size;
      }
    }
    products += keypoints * keypoints.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(products);
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    views_[chosen[k]] = eigen.eigenvectors().rightCols<3>().middleRows<2>(static_cast<Eigen::Index>(2 * k));
  }
  CentreAll();
  return true;
}

void AffineSolver::CentreAll() {
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    for (std::size_t v = 0; v < views_.size(); ++v) {
      std::vector<std::size_t> seen;
      for (std::size_t j = 0; j < joint_count(); ++j) {
        if (capture_.Sees(frames_[i], static_cast<int>(v), static_cast<int>(j))) seen.push_back(j);
      }
      if (!seen.empty()) Centre(i, v, seen);
    }
  }
}

void AffineSolver::StartFrom(const std::vector<AffineView>& views) {
  views_ = views;
  CentreAll();
}

/// Joints from the views that see them, given views, scales and offsets.
void AffineSolver::FindJoints() {
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    for (std::size_t j = 0; j < joint_count(); ++j) {
      Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
      Eigen::Vector3d right = Eigen::Vector3d::Zero();
      int seen = 0;
      for (std::size_t v = 0; v < views_.size(); ++v) {
        if (!Sees(i, v, j)) continue;
        const AffineView rows = scales_[i * views_.size() + v] * views_[v];
        normal += rows.transpose() * rows;
        right += rows.transpose() * (At(i, v, j) - offsets_[i * views_.size() + v]);
        ++seen;
      }
      Eigen::Vector3d& joint = joints_[i * joint_count() + j];
      joint = seen >= 2 ? normal.ldlt().solve(right).eval() : Eigen::Vector3d::Constant(std::nan("")).eval();
    }
  }
}

/// Each view's scale and offset in each frame, given views and joints. The geometric mean of a frame's scales is 1.
void AffineSolver::FindScales() {
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    double log_scales = 0.0;
    int found = 0;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> pairs;  // keypoint, projected joint
      for (std::size_t j = 0; j < joint_count(); ++j) {
        const Eigen::Vector3d& joint = joints_[i * joint_count() + j];
        if (Sees(i, v, j) && joint.allFinite()) pairs.emplace_back(At(i, v, j), views_[v] * joint);
      }
      if (pairs.size() < 3) continue;
      const auto count = static_cast<double>(pairs.size());
      Eigen::Vector2d sum_seen = Eigen::Vector2d::Zero();
      Eigen::Vector2d sum_model = Eigen::Vector2d::Zero();
      for (const auto& [seen, model] : pairs) {
        sum_seen += seen;
        sum_model += model;
      }
      double product = 0.0;
      double squares = 0.0;
      for (const auto& [seen, model] : pairs) {
        product += (seen - sum_seen / count).dot(model - sum_model / count);
        squares += (model - sum_model / count).squaredNorm();
      }
      if (!(product > 0.0) || !(squares > 0.0)) continue;
      const double scale = product / squares;
      scales_[i * views_.size() + v] = scale;
      offsets_[i * views_.size() + v] = (sum_seen - scale * sum_model) / count;
      log_scales += std::log(scale);
      ++found;
    }
    if (found == 0) continue;
    for (std::size_t v = 0; v < views_.size(); ++v) scales_[i * views_.size() + v] /= std::exp(log_scales / found);
  }
}

/// Each view's two rows, given joints, scales and offsets; keypoints that are far off count little.
void AffineSolver::FindViews() {
  for (std::size_t v = 0; v < views_.size(); ++v) {
    const AffineView before = views_[v];
    std::vector<double> errors;
    VisitSeen(v, [&](const Eigen::Vector2d& seen, const Eigen::Vector3d& joint) {
      errors.push_back((seen - before * joint).norm());
    });
    if (errors.empty()) continue;
    const double limit = 3.0 * Median(std::move(errors)) + 1e-12;
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    AffineView right = AffineView::Zero();
    VisitSeen(v, [&](const Eigen::Vector2d& seen, const Eigen::Vector3d& joint) {
      const double error = before.allFinite() ? (seen - before * joint).norm() : 0.0;
      const double weight = 1.0 / (1.0 + std::pow(error / limit, 2));
      normal += weight * joint * joint.transpose();
      right += weight * seen * joint.transpose();
    });
    if (normal.determinant() > 0.0) views_[v] = right * normal.inverse();
  }
}

/// The rotation whose first two rows are nearest to a multiple of a view's.
Eigen::Matrix3d RotationOf(const AffineView& view) {
  Eigen::Matrix3d rows;
  const AffineView normalised = view / view.norm();
  rows.topRows<2>() = normalised;
  rows.row(2) = normalised.row(0).cross(normalised.row(1)).normalized() * normalised.row(0).norm();
  return NearestRotation(rows);
}

}  // namespace

Factorisation Factorise(const CaptureObservations& capture) {
  CANONPOSE_CHECK(capture.static_cameras, "{}", capture.name);
  const Eigen::Vector3d unknown = Eigen::Vector3d::Constant(std::nan(""));
  Factorisation result;
  result.camera_from_world.assign(capture.cameras.size(), Eigen::Matrix3d::Constant(std::nan("")));
  result.joints.assign(static_cast<std::size_t>(capture.frame_count) * capture.skeleton.joints.size(), unknown);
  const std::vector<int> frames = ConsecutiveFrames(0, capture.frame_count);
  AffineSolver some(capture, EvenlySpread(frames, kFactorisedFrames));
  if (!some.Start()) return result;
  for (int round = 0; round < kRounds; ++round) {
    some.FindJoints();
    some.FindScales();
    some.FindViews();
  }
  some.FindJoints();
  const std::optional<Eigen::Matrix3d> upgrade = MetricUpgrade(some.views(), some.joints(), capture.skeleton);
  if (!upgrade) return result;
  AffineSolver all(capture, frames);
  all.StartFrom(some.views());
  constexpr int kFrameRounds = 5;
  for (int round = 0; round < kFrameRounds; ++round) {
    all.FindJoints();
    if (round + 1 < kFrameRounds) all.FindScales();
  }
  for (std::size_t v = 0; v < capture.cameras.size(); ++v) {
    if (some.views()[v].allFinite()) result.camera_from_world[v] = RotationOf(some.views()[v] * *upgrade);
  }
  const Eigen::Matrix3d inverse = upgrade->inverse();
  for (std::size_t i = 0; i < result.joints.size(); ++i) result.joints[i] = inverse * all.joints()[i];
  return result;
}

StartPoses FactorisedStart(const Dataset& dataset, const std::string& file) {
  StartPoses start;
  start.knows_depth_sign = false;
  for (const Sequence& sequence : dataset.sequences) {
    if (!sequence.static_cameras) {
      ThrowBadInput({file, sequence.name, "static cameras", "moving ones", "choose another `bootstrap`"});
    }
    start.sequences.emplace_back(sequence.cameras.size());
  }
  const auto joints = static_cast<std::size_t>(dataset.skeleton.joint_count());
  for (const CaptureObservations& capture : CollectCaptures(dataset, start)) {
    const Factorisation found = Factorise(capture);
    for (const ClipRange& clip : capture.clips) {
      const std::vector<CameraView>& views = dataset.sequences[clip.sequence].cameras;
      for (std::size_t c = 0; c < views.size(); ++c) {
        const auto v = static_cast<std::size_t>(capture.FindView(views[c].name));
        const Eigen::Matrix3d& rotation = found.camera_from_world[v];
        // The capture leaves out joints that no view sees; the start has all of the dataset's.
        std::vector<float> poses(3 * static_cast<std::size_t>(clip.count) * joints, std::nanf(""));
        for (int t = 0; t < clip.count; ++t) {
          const std::size_t first =
              static_cast<std::size_t>(clip.first + t) * static_cast<std::size_t>(capture.joint_count());
          const Eigen::Vector3d& root = found.joints[first + static_cast<std::size_t>(capture.skeleton.root)];
          for (std::size_t j = 0; j < capture.dataset_joints.size(); ++j) {
            const Eigen::Vector3d p = rotation * (found.joints[first + j] - root);
            const std::size_t to =
                static_cast<std::size_t>(t) * joints + static_cast<std::size_t>(capture.dataset_joints[j]);
            for (std::size_t axis = 0; axis < 3; ++axis)
              poses[3 * to + axis] = static_cast<float>(p[static_cast<Eigen::Index>(axis)]);
          }
        }
        start.sequences[clip.sequence][c] = PosesAboutRoot(dataset.skeleton, std::move(poses), views[c].name);
      }
    }
  }
  return start;
}

}  // namespace canonpose
