#include "canonpose/train/mirror.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "canonpose/base/log.h"
#include "canonpose/train/losses.h"

namespace canonpose {
namespace {

constexpr int kMinClips = 4;
constexpr std::size_t kMaxFrames = 20000;
constexpr std::int64_t kChunkFrames = 1024;

/// Adds the pairs of a chunk of frames to the regressions of their clips.
void AddChunk(LiftingNetwork& lifter, const TrainingSet& set, const std::vector<const TrainingFrame*>& frames, int root,
              torch::Device device, std::map<int, SlopeRegression>& regressions) {
  const BatchTensors batch = GatherBatch(set, frames, device);
  const LifterOutput output = lifter.forward(LifterInput(batch));
  const PairList pairs = MakeBatchPairs(frames, set.static_captures, false, nullptr).view;
  const torch::Tensor target = torch::tensor(pairs.target, torch::kInt64).to(device);
  const torch::Tensor source = torch::tensor(pairs.source, torch::kInt64).to(device);
  torch::Tensor rotated = torch::bmm(output.rotation.index_select(0, target), output.pose.index_select(0, source));
  rotated = rotated - rotated.narrow(2, root, 1);
  const torch::Tensor confidence = batch.confidence.index_select(0, target);
  const torch::Tensor seen = (confidence > 0).to(rotated.scalar_type()).unsqueeze(1);  // (P, 1, J)
  const auto norm = [&](const torch::Tensor& points) {
    return torch::sqrt(torch::clamp_min((points * points * seen).sum({1, 2}), 1e-12)).view({-1, 1, 1});
  };
  const torch::Tensor depth =
      (rotated.narrow(1, 2, 1) / norm(rotated)).to(torch::kCPU, torch::kFloat64).contiguous();  // (P, 1, J)
  const torch::Tensor projected_raw = rotated.narrow(1, 0, 2);
  const torch::Tensor keypoints_raw = batch.keypoints.index_select(0, target);
  const torch::Tensor projected = (projected_raw / norm(projected_raw)).to(torch::kCPU, torch::kFloat64).contiguous();
  const torch::Tensor keypoints = (keypoints_raw / norm(keypoints_raw)).to(torch::kCPU, torch::kFloat64).contiguous();
  const torch::Tensor weight = confidence.to(torch::kCPU, torch::kFloat64).contiguous();

  std::vector<int> clips;  // by row
  for (const TrainingFrame* frame : frames) clips.insert(clips.end(), frame->views.size(), frame->clip);
  const auto joints = static_cast<std::int64_t>(set.joint_count);
  const double* z = depth.data_ptr<double>();
  const double* q = projected.data_ptr<double>();
  const double* w = keypoints.data_ptr<double>();
  const double* c = weight.data_ptr<double>();
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    SlopeRegression& regression = regressions[clips[static_cast<std::size_t>(pairs.target[p])]];
    const auto pair = static_cast<std::int64_t>(p);
    for (std::int64_t axis = 0; axis < 2; ++axis) {
      for (std::int64_t j = 0; j < joints; ++j) {
        const std::int64_t point = (pair * 2 + axis) * joints + j;
        regression.Add(w[point] - q[point], q[point], z[pair * joints + j], c[pair * joints + j]);
      }
    }
  }
}

}  // namespace

double PerspectiveSlope::standard_errors() const {
  if (clips < 2 || !(standard_error > 0.0)) return 0.0;
  return std::abs(slope) / standard_error;
}

bool PerspectiveSlope::is_sure() const { return clips >= kMinClips && standard_errors() >= kSure; }

std::string PerspectiveSlope::Describe() const {
  return fmt::format("slope {:+.3f} +- {:.3f} over {} clips", slope, standard_error, clips);
}

void SlopeRegression::Add(double residual, double reprojection, double depth, double weight) {
  const double zq = depth * reprojection;
  zz_ += weight * zq * zq;
  zq_ += weight * zq * reprojection;
  qq_ += weight * reprojection * reprojection;
  rz_ += weight * residual * zq;
  rq_ += weight * residual * reprojection;
}

bool SlopeRegression::Solve(double& slope) const {
  const double determinant = zz_ * qq_ - zq_ * zq_;
  if (!(determinant > 1e-12 * zz_ * qq_) || !(zz_ > 0.0)) return false;
  slope = (rz_ * qq_ - rq_ * zq_) / determinant;
  return std::isfinite(slope);
}

PerspectiveSlope CombineSlopes(const std::vector<double>& slopes) {
  PerspectiveSlope combined;
  combined.clips = static_cast<int>(slopes.size());
  if (slopes.empty()) return combined;
  const auto count = static_cast<double>(slopes.size());
  for (const double slope : slopes) combined.slope += slope / count;
  double squares = 0.0;
  for (const double slope : slopes) squares += (slope - combined.slope) * (slope - combined.slope);
  if (slopes.size() > 1) combined.standard_error = std::sqrt(squares / (count - 1.0) / count);
  return combined;
}

PerspectiveSlope MeasurePerspectiveSlope(LiftingNetwork& lifter, const TrainingSet& set, int root,
                                         torch::Device device) {
  const torch::NoGradGuard no_grad;
  // Every n-th frame of a long set is enough.
  const std::size_t stride = set.frames.size() / kMaxFrames + 1;
  std::map<int, SlopeRegression> regressions;
  std::vector<const TrainingFrame*> chunk;
  for (std::size_t n = 0; n < set.frames.size(); n += stride) {
    chunk.push_back(&set.frames[n]);
    if (static_cast<std::int64_t>(chunk.size()) == kChunkFrames || n + stride >= set.frames.size()) {
      AddChunk(lifter, set, chunk, root, device, regressions);
      chunk.clear();
    }
  }
  std::vector<double> slopes;
  for (const auto& [clip, regression] : regressions) {
    double slope = 0.0;
    if (regression.Solve(slope)) slopes.push_back(slope);
  }
  return CombineSlopes(slopes);
}

bool UpdateMirrorDecision(const PerspectiveSlope& slope, MirrorHandling handling, MirrorDecision& decision) {
  const bool decided_before = decision.decision != "undecided";
  if (handling != MirrorHandling::kAuto) {
    if (decided_before) return false;
    const bool flips = handling == MirrorHandling::kFlip;
    decision = {flips ? "flipped by request" : "kept by request", slope.slope, slope.standard_error};
    LogInfo("mirror: {} ({}; a negative slope is right)", decision.decision, slope.Describe());
    return flips;
  }
  if (!slope.is_sure() && decided_before) {
    LogInfo("mirror: the decision after the warm-up stands, {} ({} is not enough to decide again)", decision.decision,
            slope.Describe());
    return false;
  }
  if (!slope.is_sure()) {
    decision = {"undecided", slope.slope, slope.standard_error};
    const std::string reason =
        slope.clips < kMinClips
            ? fmt::format("the recording is too short to decide ({}; {} clips are needed): record more",
                          slope.Describe(), kMinClips)
            : fmt::format(
                  "perspective is too weak to decide, or training found no good solution ({}, {:.1f} standard errors; "
                  "{} "
                  "are needed): try another `seed`",
                  slope.Describe(), slope.standard_errors(), PerspectiveSlope::kSure);
    LogWarning(
        "mirror: undecided, the 3D poses may be depth-reversed (front and back exchanged): {}, or look at the poses "
        "and train again with `mirror=keep` or `mirror=flip`",
        reason);
    return false;
  }
  if (!decided_before || slope.is_mirrored()) {
    decision = {slope.is_mirrored() ? "flipped" : "kept", slope.slope, slope.standard_error};
  }
  const char* what = "depths are the right way round, kept";
  if (decided_before) what = "confirmed after training, depths are the right way round";
  if (slope.is_mirrored()) what = "depths were reversed, flipped";
  LogInfo("mirror: {} ({}, {:.1f} standard errors; a negative slope is right)", what, slope.Describe(),
          slope.standard_errors());
  return slope.is_mirrored();
}

}  // namespace canonpose
