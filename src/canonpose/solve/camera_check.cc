#include "canonpose/solve/camera_check.h"

#include <algorithm>
#include <cmath>

#include "canonpose/base/median.h"
#include "canonpose/solve/calibration.h"
#include "canonpose/solve/diagnosis.h"
#include "canonpose/solve/initialisation.h"

namespace canonpose {
namespace {

/// Runs of consecutive frames of a clip in which offsets are looked for.
constexpr int kOffsetRuns = 4;
constexpr int kOffsetRunFrames = 60;
/// With fewer frames of its own a camera has no offset that could be told.
constexpr int kLeastOffsetFrames = 20;
/// An offset is believed where it fits better by this many standard errors and this share of the cost.
constexpr double kOffsetSigma = 4.0;
constexpr double kOffsetShare = 0.05;
constexpr int kOffsetRounds = 3;
constexpr double kBoneScatter = 0.1;
constexpr double kBlockSeconds = 0.5;
/// Frames in which disagreement is measured.
constexpr int kDisagreementFrames = 300;
/// A view may not belong where the others see its keypoints farther off than this, body units: 0.8 to 2.2 % are usual,
/// 10 to 30 % where it shows somebody else.
constexpr double kSuspectDisagreement = 0.04;
/// It does not where the others without it explain their keypoints this well, and so much better than with it: 0.25 to
/// 0.6 % are usual, 0.7 to 6 % with a view of somebody else.
constexpr double kAgreement = 0.015;
constexpr double kAgreementGain = 0.8;

double Cauchy(double error) { return std::log1p(error * error / (kLossScale * kLossScale)); }

int UsedViews(const CaptureObservations& capture, const Solution& solution, int frame) {
  int used = 0;
  for (int v = 0; v < capture.view_count(); ++v) used += solution.estimate.CameraAt(frame, v).valid ? 1 : 0;
  return used;
}

/// The distance of a keypoint from a joint's projection, in body units; NaN where it is behind the camera.
double DistanceOf(const CaptureObservations& capture, const Solution& solution, int frame, int view, int joint,
                  const Eigen::Vector3d& point) {
  const CameraEstimate& camera = solution.estimate.CameraAt(frame, view);
  const Eigen::Vector3d p = camera.Rotation() * point + solution.estimate.Translation(frame, view);
  if (!(p.z() > 0.0)) return std::nan("");
  return (p.head<2>() - capture.At(frame, view, joint) * p.z() / camera.Focal()).norm();
}

double Scatter(const CaptureObservations& capture, const Solution& solution, int frame, int view, int joint) {
  return solution.scales.observation.Scatter(joint, capture.confidence[capture.Index(frame, view, joint)]);
}

/// How a view fits the others in a clip at each offset -most .. most; one mean cost for each frame that was looked at.
class OffsetSearch {
 public:
  OffsetSearch(const CaptureObservations& capture, const Solution& solution, int clip, int view);
  [[nodiscard]] OffsetEstimate Best() const;

 private:
  void LookAt(int frame);
  /// The mean cost of the view's keypoints of `frame` at an offset; NaN where there is nothing to compare.
  [[nodiscard]] double CostAgainstOthers(int frame, int offset);
  [[nodiscard]] double CostOfPair(int frame, int offset) const;
  const std::vector<Eigen::Vector3d>& OthersAt(int frame);
  [[nodiscard]] std::vector<double> BlockMeans(int offset_index) const;

  const CaptureObservations& capture_;
  const Solution& solution_;
  const ClipRange& clip_;
  int view_;
  int other_view_ = -1;  ///< where there are two alone
  int most_ = kMostOffset;
  std::vector<std::vector<Eigen::Vector3d>> others_;  ///< by frame of the clip; empty: not yet asked for
  std::vector<int> frames_;
  std::vector<std::vector<double>> costs_;  ///< (2 most + 1, frames)
};

OffsetSearch::OffsetSearch(const CaptureObservations& capture, const Solution& solution, int clip, int view)
    : capture_(capture),
      solution_(solution),
      clip_(capture.clips[static_cast<std::size_t>(clip)]),
      view_(view),
      others_(static_cast<std::size_t>(clip_.count)) {
  if (!solution.estimate.CameraAt(clip_.first, view).valid) return;
  if (UsedViews(capture, solution, clip_.first) == 2) {
    for (int v = 0; v < capture.view_count(); ++v) {
      if (v != view && solution.estimate.CameraAt(clip_.first, v).valid) other_view_ = v;
    }
  }
  most_ = std::min(kMostOffset, (clip_.count - kLeastOffsetFrames) / 2);
  if (most_ < 1) return;
  costs_.resize(static_cast<std::size_t>(2 * most_ + 1));
  const int count = clip_.count - 2 * most_;  // frames that have all their neighbours
  const int runs = std::clamp(count / kOffsetRunFrames, 1, kOffsetRuns);
  int next = 0;
  for (int r = 0; r < runs; ++r) {
    const int first = runs == 1 ? 0 : r * (count - kOffsetRunFrames) / (runs - 1);
    for (int t = std::max(first, next);
         t < std::min(count, runs == 1 ? kOffsetRuns * kOffsetRunFrames : first + kOffsetRunFrames); ++t) {
      LookAt(clip_.first + most_ + t);
      next = t + 1;
    }
  }
}

const std::vector<Eigen::Vector3d>& OffsetSearch::OthersAt(int frame) {
  std::vector<Eigen::Vector3d>& joints = others_[static_cast<std::size_t>(frame - clip_.first)];
  if (joints.empty()) {
    for (int j = 0; j < capture_.joint_count(); ++j) {
      joints.push_back(TriangulateJoint(capture_, frame, j, solution_.scales, solution_.estimate, view_).point);
    }
  }
  return joints;
}

double OffsetSearch::CostAgainstOthers(int frame, int offset) {
  const std::vector<Eigen::Vector3d>& joints = OthersAt(frame + offset);
  double sum = 0.0;
  int count = 0;
  for (int j = 0; j < capture_.joint_count(); ++j) {
    if (!capture_.Sees(frame, view_, j)) continue;
    const double error = DistanceOf(capture_, solution_, frame, view_, j, joints[static_cast<std::size_t>(j)]);
    if (!std::isfinite(error)) continue;
    sum += Cauchy(error / Scatter(capture_, solution_, frame, view_, j));
    ++count;
  }
  return sum / count;
}

/// Two views: how well rays of the one in `frame` and of the other in `frame` + `offset` meet, and whether bones keep
/// their lengths.
double OffsetSearch::CostOfPair(int frame, int offset) const {
  const int other_frame = frame + offset;
  double sum = 0.0;
  int count = 0;
  std::vector<Eigen::Vector3d> joints;
  // Both views in one frame of a capture of its own.
  CaptureObservations pair;
  pair.skeleton = capture_.skeleton;
  pair.cameras = capture_.cameras;
  const auto joint_count = static_cast<std::ptrdiff_t>(capture_.joint_count());
  pair.xy.assign(2 * capture_.cameras.size() * capture_.skeleton.joints.size(), std::nanf(""));
  pair.confidence.assign(capture_.cameras.size() * capture_.skeleton.joints.size(), 0.0F);
  const auto take = [&](int from_frame, int v) {
    const auto from = static_cast<std::ptrdiff_t>(capture_.Index(from_frame, v, 0));
    std::copy_n(capture_.xy.begin() + 2 * from, 2 * joint_count, &pair.xy[2 * pair.Index(0, v, 0)]);
    std::copy_n(capture_.confidence.begin() + from, joint_count, &pair.confidence[pair.Index(0, v, 0)]);
  };
  take(frame, view_);
  take(other_frame, other_view_);
  for (int j = 0; j < capture_.joint_count(); ++j) {
    joints.push_back(TriangulateJoint(pair, 0, j, solution_.scales, solution_.estimate).point);
    if (!joints.back().allFinite()) continue;
    for (const int v : {view_, other_view_}) {
      const double error = DistanceOf(pair, solution_, 0, v, j, joints.back());
      if (!std::isfinite(error)) continue;
      sum += Cauchy(error / Scatter(pair, solution_, 0, v, j));
      ++count;
    }
  }
  const std::vector<double>& lengths = solution_.estimate.log_bone_lengths[static_cast<std::size_t>(clip_.subject)];
  for (int j = 0; j < capture_.joint_count(); ++j) {
    const int parent = capture_.skeleton.parents[static_cast<std::size_t>(j)];
    if (parent < 0) continue;
    const Eigen::Vector3d bone = joints[static_cast<std::size_t>(j)] - joints[static_cast<std::size_t>(parent)];
    const double error = std::log(bone.norm()) - lengths[static_cast<std::size_t>(j)];
    if (std::isfinite(error)) sum += Cauchy(error / kBoneScatter);
  }
  return sum / count;
}

void OffsetSearch::LookAt(int frame) {
  std::vector<double> costs;
  for (int offset = -most_; offset <= most_; ++offset) {
    costs.push_back(other_view_ >= 0 ? CostOfPair(frame, offset) : CostAgainstOthers(frame, offset));
    // The same frames for all offsets, or their means could not be compared.
    if (!std::isfinite(costs.back())) return;
  }
  frames_.push_back(frame);
  for (std::size_t i = 0; i < costs.size(); ++i) costs_[i].push_back(costs[i]);
}

std::vector<double> OffsetSearch::BlockMeans(int offset_index) const {
  const std::vector<double>& costs = costs_[static_cast<std::size_t>(offset_index)];
  const std::vector<double>& now = costs_[static_cast<std::size_t>(most_)];
  std::vector<double> blocks;
  int begin = 0;
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    if (count > 0 && frames_[i] - begin > kBlockSeconds * clip_.fps) {
      blocks.push_back(sum / count);
      sum = 0.0;
      count = 0;
    }
    if (count == 0) begin = frames_[i];
    sum += now[i] - costs[i];
    ++count;
  }
  if (count > 0) blocks.push_back(sum / count);
  return blocks;
}

double Mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

OffsetEstimate OffsetSearch::Best() const {
  if (static_cast<int>(frames_.size()) < kLeastOffsetFrames) return {};
  int best = most_;
  for (int i = 0; i < static_cast<int>(costs_.size()); ++i) {
    if (Mean(costs_[static_cast<std::size_t>(i)]) < Mean(costs_[static_cast<std::size_t>(best)])) best = i;
  }
  if (best == most_) return {};
  const double now = Mean(costs_[static_cast<std::size_t>(most_)]);
  if (now - Mean(costs_[static_cast<std::size_t>(best)]) < kOffsetShare * now) return {};
  const std::vector<double> blocks = BlockMeans(best);
  if (blocks.size() < 2) return {};
  const double mean = Mean(blocks);
  double squares = 0.0;
  for (const double block : blocks) squares += (block - mean) * (block - mean);
  const double error = std::sqrt(squares / static_cast<double>(blocks.size() * (blocks.size() - 1)));
  if (mean < kOffsetSigma * error) return {};
  return {best - most_, mean};
}

}  // namespace

void ShiftView(CaptureObservations& capture, int clip, int view, int frames) {
  const ClipRange& range = capture.clips[static_cast<std::size_t>(clip)];
  const CaptureObservations before = capture;
  const int joints = capture.joint_count();
  for (int n = range.first; n < range.first + range.count; ++n) {
    const int source = n - frames;
    const bool is_there = source >= range.first && source < range.first + range.count;
    const std::size_t to = capture.Index(n, view, 0);
    const std::size_t from = is_there ? capture.Index(source, view, 0) : 0;
    const auto move = [&](std::vector<float>& values, const std::vector<float>& old, std::size_t width, float none) {
      const std::size_t count = width * static_cast<std::size_t>(joints);
      if (is_there) std::copy_n(&old[width * from], count, &values[width * to]);
      if (!is_there) std::fill_n(&values[width * to], count, none);
    };
    move(capture.xy, before.xy, 2, std::nanf(""));
    move(capture.confidence, before.confidence, 1, 0.0F);
    move(capture.start, before.start, 3, std::nanf(""));
  }
}

void DropView(CaptureObservations& capture, int view) {
  for (int n = 0; n < capture.frame_count; ++n) {
    for (int j = 0; j < capture.joint_count(); ++j) {
      const std::size_t i = capture.Index(n, view, j);
      capture.confidence[i] = 0.0F;
      std::fill_n(&capture.xy[2 * i], 2, std::nanf(""));
      std::fill_n(&capture.start[3 * i], 3, std::nanf(""));
    }
  }
}

double DisagreementOf(const CaptureObservations& capture, const Solution& solution, int view) {
  std::vector<double> errors;
  const int step = std::max(1, capture.frame_count / kDisagreementFrames);
  for (int n = 0; n < capture.frame_count; n += step) {
    if (!solution.estimate.CameraAt(n, view).valid) continue;
    const int left_out = UsedViews(capture, solution, n) > 2 ? view : -1;
    for (int j = 0; j < capture.joint_count(); ++j) {
      if (!capture.Sees(n, view, j)) continue;
      const Triangulation others = TriangulateJoint(capture, n, j, solution.scales, solution.estimate, left_out);
      if (!others.point.allFinite()) continue;
      const double error = DistanceOf(capture, solution, n, view, j, others.point);
      if (std::isfinite(error)) errors.push_back(error);
    }
  }
  return Median(std::move(errors));
}

OffsetEstimate EstimateOffset(const CaptureObservations& capture, const Solution& solution, int clip, int view) {
  return OffsetSearch(capture, solution, clip, view).Best();
}

namespace {

int LastUsedView(const CaptureObservations& capture, const Solution& solution) {
  int last = -1;
  for (int v = 0; v < capture.view_count(); ++v) {
    if (solution.estimate.CameraAt(0, v).valid) last = v;
  }
  return last;
}

/// Moves views of a clip in time, that with most to gain first, until they all fit. Adds to `offsets` (clips, V).
bool AlignClip(CaptureObservations& capture, const Solution& solution, int clip, std::vector<int>& offsets) {
  const bool is_pair = UsedViews(capture, solution, 0) == 2;
  bool moved = false;
  for (int round = 0; round < 2 * capture.view_count(); ++round) {
    OffsetEstimate best;
    int best_view = -1;
    for (int v = 0; v < capture.view_count(); ++v) {
      if (!solution.estimate.CameraAt(0, v).valid) continue;
      if (is_pair && v != LastUsedView(capture, solution)) continue;
      const OffsetEstimate found = EstimateOffset(capture, solution, clip, v);
      if (found.gain <= best.gain) continue;
      best = found;
      best_view = v;
    }
    if (best_view < 0) break;
    ShiftView(capture, clip, best_view, best.frames);
    offsets[static_cast<std::size_t>(best_view)] += best.frames;
    moved = true;
  }
  return moved;
}

bool AlignCameras(CaptureObservations& capture, const Calibrate& calibrate, Solution& solution,
                  std::vector<std::vector<int>>& offsets) {
  bool any = false;
  for (int round = 0; round < kOffsetRounds; ++round) {
    bool moved = false;
    for (std::size_t clip = 0; clip < capture.clips.size(); ++clip) {
      moved = AlignClip(capture, solution, static_cast<int>(clip), offsets[clip]) || moved;
    }
    if (!moved) break;
    any = true;
    solution = calibrate(capture);
  }
  return any;
}

/// The view without which the others agree, and then their solution; -1 where there is none.
int FindStranger(const CaptureObservations& capture, const Calibrate& calibrate, Solution& solution) {
  double worst = 0.0;
  std::vector<int> used;
  for (int v = 0; v < capture.view_count(); ++v) {
    const double disagreement = DisagreementOf(capture, solution, v);
    if (!std::isfinite(disagreement)) continue;
    used.push_back(v);
    worst = std::max(worst, disagreement);
  }
  if (used.size() < 3 || worst < kSuspectDisagreement) return -1;
  double best = std::min(kAgreement, kAgreementGain * MedianError(capture, solution));
  int stranger = -1;
  Solution found;
  for (const int v : used) {
    CaptureObservations without = capture;
    DropView(without, v);
    if (static_cast<int>(FramesWithStart(without).size()) < kLeastFrames) continue;
    Solution candidate = calibrate(without);
    const double error = MedianError(without, candidate);
    if (!(error < best)) continue;
    best = error;
    stranger = v;
    found = std::move(candidate);
  }
  if (stranger >= 0) solution = std::move(found);
  return stranger;
}

/// Has most cameras of each clip keep their time.
void KeepMajority(CaptureObservations& capture, const std::vector<bool>& dropped,
                  std::vector<std::vector<int>>& offsets) {
  for (std::size_t clip = 0; clip < offsets.size(); ++clip) {
    std::vector<int> used;
    for (std::size_t v = 0; v < dropped.size(); ++v) {
      if (!dropped[v]) used.push_back(offsets[clip][v]);
    }
    int most = 0;
    for (const int offset : used) {
      if (std::ranges::count(used, offset) > std::ranges::count(used, most)) most = offset;
    }
    for (std::size_t v = 0; most != 0 && v < dropped.size(); ++v) {
      ShiftView(capture, static_cast<int>(clip), static_cast<int>(v), -most);
      offsets[clip][v] -= most;
    }
  }
}

}  // namespace

double MedianError(const CaptureObservations& capture, const Solution& solution) {
  std::vector<double> errors;
  for (int n = 0; n < capture.frame_count; ++n) {
    VisitErrors(capture, std::span(&n, 1), solution.estimate,
                [&](int, int, int, double error) { errors.push_back(error); });
  }
  return Median(std::move(errors));
}

CameraCheck CheckCameras(CaptureObservations& capture, const Calibrate& calibrate, Solution& solution) {
  CameraCheck check;
  check.offsets.assign(capture.clips.size(), std::vector<int>(capture.cameras.size(), 0));
  check.dropped.assign(capture.cameras.size(), false);
  for (;;) {
    if (capture.static_cameras) AlignCameras(capture, calibrate, solution, check.offsets);
    const int stranger = FindStranger(capture, calibrate, solution);
    if (stranger < 0) break;
    DropView(capture, stranger);
    check.dropped[static_cast<std::size_t>(stranger)] = true;
    for (std::vector<int>& offsets : check.offsets) offsets[static_cast<std::size_t>(stranger)] = 0;
  }
  KeepMajority(capture, check.dropped, check.offsets);
  return check;
}

}  // namespace canonpose
