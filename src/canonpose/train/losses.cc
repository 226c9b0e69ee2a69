#include "canonpose/train/losses.h"

#include <algorithm>
#include <map>

namespace canonpose {
namespace {

constexpr double kSmallestPerspectiveDivisor = 0.1;

/// Row of each view in each frame, by camera; -1 where the camera missed the person.
struct RowTable {
  explicit RowTable(const std::vector<const TrainingFrame*>& frames) : first_row(frames.size()) {
    std::int64_t row = 0;
    for (std::size_t n = 0; n < frames.size(); ++n) {
      first_row[n] = row;
      row += static_cast<std::int64_t>(frames[n]->views.size());
    }
    row_count = row;
  }
  std::vector<std::int64_t> first_row;  // (frames)
  std::int64_t row_count = 0;
};

void AddViewPairs(const std::vector<const TrainingFrame*>& frames, const RowTable& rows, PairList& pairs) {
  for (std::size_t n = 0; n < frames.size(); ++n) {
    const auto views = static_cast<std::int64_t>(frames[n]->views.size());
    if (views < 2) continue;
    const double weight = 1.0 / (static_cast<double>(frames.size()) * static_cast<double>(views - 1));
    for (std::int64_t i = 0; i < views; ++i) {
      for (std::int64_t j = 0; j < views; ++j) {
        if (i == j) continue;
        pairs.source.push_back(rows.first_row[n] + i);
        pairs.target.push_back(rows.first_row[n] + j);
        pairs.weight.push_back(weight);
      }
    }
  }
}

/// The frames of one capture in a batch: the row of each camera, and which frames may exchange relative rotations.
struct CaptureRows {
  std::vector<std::vector<std::int64_t>> by_frame;                    // [frame][camera], -1 where missing
  std::map<std::int64_t, std::vector<std::size_t>> frames_of_window;  // indices into by_frame
};

void AddCameraPairs(const CaptureRows& capture, std::size_t cameras, const DrawPermutation& draw, PairList& pairs) {
  for (std::size_t i = 0; i < cameras; ++i) {
    const std::size_t first = pairs.size();
    for (const auto& [window, frames] : capture.frames_of_window) {
      if (frames.size() < 2) continue;
      const std::vector<std::size_t> permutation = draw(frames.size());
      for (std::size_t n = 0; n < frames.size(); ++n) {
        const auto& own = capture.by_frame[frames[n]];
        const auto& other = capture.by_frame[frames[permutation[n]]];
        for (std::size_t j = 0; j < cameras; ++j) {
          if (j == i || own[i] < 0 || own[j] < 0 || other[i] < 0 || other[j] < 0) continue;
          pairs.source.push_back(own[i]);
          pairs.target.push_back(own[j]);
          pairs.to.push_back(other[j]);
          pairs.from.push_back(other[i]);
        }
      }
    }
    const std::size_t count = pairs.size() - first;
    pairs.weight.insert(pairs.weight.end(), count, count == 0 ? 0.0 : 1.0 / static_cast<double>(count));
  }
}

torch::Tensor IndexTensor(const std::vector<std::int64_t>& indices, torch::Device device) {
  return torch::tensor(indices, torch::kInt64).to(device);
}

/// sqrt(sum of squares / (2 x joints seen)) of (P, 2, J), 1 where it would be zero.
torch::Tensor SeenNorm(const torch::Tensor& points, const torch::Tensor& seen) {
  const torch::Tensor count = 2 * seen.sum(1);                                      // (P)
  const torch::Tensor squares = (points * points * seen.unsqueeze(1)).sum({1, 2});  // (P)
  return torch::sqrt(torch::clamp_min(squares / torch::clamp_min(count, 1), 1e-12)).view({-1, 1, 1});
}

torch::Tensor WeightedError(const torch::Tensor& rotated, const PairList& pairs, const BatchTensors& batch,
                            const torch::Tensor& targets, const torch::Tensor& perspective, int root) {
  const torch::Tensor weight = torch::tensor(pairs.weight, torch::kFloat64).to(rotated.options());
  const torch::Tensor errors = PairErrors(Project(rotated, perspective, root), batch.keypoints.index_select(0, targets),
                                          batch.confidence.index_select(0, targets));
  return (errors * weight).sum();
}

}  // namespace

BatchPairs MakeBatchPairs(const std::vector<const TrainingFrame*>& frames,
                          const std::vector<std::uint8_t>& static_captures, bool with_camera_loss,
                          const DrawPermutation& draw_permutation, const std::vector<std::int64_t>& windows) {
  BatchPairs pairs;
  const RowTable rows(frames);
  for (std::int64_t row = 0; row < rows.row_count; ++row) {
    pairs.reprojection.source.push_back(row);
    pairs.reprojection.target.push_back(row);
    pairs.reprojection.weight.push_back(1.0 / static_cast<double>(rows.row_count));
  }
  AddViewPairs(frames, rows, pairs.view);
  if (!with_camera_loss) return pairs;

  std::map<int, std::size_t> camera_counts;
  for (const TrainingFrame* frame : frames) {
    std::size_t& count = camera_counts[frame->capture];
    for (const TrainingView& view : frame->views) count = std::max(count, static_cast<std::size_t>(view.camera) + 1);
  }
  std::map<int, CaptureRows> captures;
  for (std::size_t n = 0; n < frames.size(); ++n) {
    const TrainingFrame& frame = *frames[n];
    std::vector<std::int64_t> by_camera(camera_counts[frame.capture], -1);
    for (std::size_t v = 0; v < frame.views.size(); ++v) {
      by_camera[static_cast<std::size_t>(frame.views[v].camera)] = rows.first_row[n] + static_cast<std::int64_t>(v);
    }
    CaptureRows& capture = captures[frame.capture];
    capture.frames_of_window[windows.empty() ? 0 : windows[n]].push_back(capture.by_frame.size());
    capture.by_frame.push_back(std::move(by_camera));
  }
  for (const auto& [capture, capture_rows] : captures) {
    if (windows.empty() && static_captures[static_cast<std::size_t>(capture)] == 0) continue;
    AddCameraPairs(capture_rows, camera_counts[capture], draw_permutation, pairs.camera);
  }
  return pairs;
}

BatchTensors GatherBatch(const TrainingSet& set, const std::vector<const TrainingFrame*>& frames, torch::Device device,
                         const RowChange& change) {
  std::int64_t rows = 0;
  for (const TrainingFrame* frame : frames) rows += static_cast<std::int64_t>(frame->views.size());
  const auto joints = static_cast<std::int64_t>(set.joint_count);
  BatchTensors batch{torch::empty({rows, 2, joints}), torch::empty({rows, joints}), {}, {}};
  if (!set.target.empty()) batch.target = torch::empty({rows, 3, joints});
  if (!set.target_weight.empty()) batch.target_weight = torch::empty({rows, joints});
  TrainingRow row{batch.keypoints.data_ptr<float>(), batch.confidence.data_ptr<float>(),
                  batch.target.defined() ? batch.target.data_ptr<float>() : nullptr,
                  batch.target_weight.defined() ? batch.target_weight.data_ptr<float>() : nullptr};
  const auto copy = [](const std::vector<float>& from, std::int64_t index, std::int64_t size, float* to) {
    if (to != nullptr) std::copy_n(from.begin() + index * size, size, to);
  };
  for (const TrainingFrame* frame : frames) {
    for (const TrainingView& view : frame->views) {
      copy(set.keypoints, view.row, 2 * joints, row.keypoints);
      copy(set.confidence, view.row, joints, row.confidence);
      copy(set.target, view.row, 3 * joints, row.target);
      copy(set.target_weight, view.row, joints, row.target_weight);
      if (change) change(view.row, row);
      row.keypoints += 2 * joints;
      row.confidence += joints;
      if (row.target != nullptr) row.target += 3 * joints;
      if (row.target_weight != nullptr) row.target_weight += joints;
    }
  }
  for (torch::Tensor* tensor : {&batch.keypoints, &batch.confidence, &batch.target, &batch.target_weight}) {
    if (tensor->defined()) *tensor = tensor->to(device);
  }
  return batch;
}

torch::Tensor LifterInput(const BatchTensors& batch) {
  return torch::cat({batch.keypoints.flatten(1), batch.confidence}, 1);
}

torch::Tensor Project(const torch::Tensor& pose_in_camera, const torch::Tensor& perspective, int root) {
  const torch::Tensor xy = pose_in_camera.narrow(1, 0, 2);
  if (!perspective.defined()) return xy;
  const torch::Tensor centred = pose_in_camera - pose_in_camera.narrow(2, root, 1);  // (P, 3, J)
  const torch::Tensor norm = torch::sqrt(torch::clamp_min((centred * centred).sum({1, 2}), 1e-12)).view({-1, 1, 1});
  const torch::Tensor depth = centred.narrow(1, 2, 1) / norm;  // (P, 1, J)
  return xy / torch::clamp_min(1 + perspective * depth, kSmallestPerspectiveDivisor);
}

torch::Tensor PairErrors(const torch::Tensor& projected, const torch::Tensor& keypoints,
                         const torch::Tensor& confidence) {
  const torch::Tensor seen = (confidence > 0).to(projected.scalar_type());  // (P, J)
  const torch::Tensor difference = keypoints / SeenNorm(keypoints, seen) - projected / SeenNorm(projected, seen);
  return (difference.abs().sum(1) * confidence).sum(1) / (2.0 * static_cast<double>(confidence.size(1)));
}

Losses ComputeSupervisedLoss(const LifterOutput& output, const BatchTensors& batch, int root) {
  const torch::Tensor pose = torch::bmm(output.rotation, output.pose);                      // (R, 3, J)
  const torch::Tensor known = torch::isfinite(batch.target).all(1).to(pose.scalar_type());  // (R, J)
  const torch::Tensor target = torch::nan_to_num(batch.target);                             // (R, 3, J)
  const torch::Tensor centred = (pose - pose.narrow(2, root, 1)) * known.unsqueeze(1);      // (R, 3, J)
  const torch::Tensor norm = torch::sqrt(torch::clamp_min((centred * centred).sum({1, 2}, true), 1e-12));
  const torch::Tensor squares = (centred / norm - target).square().sum(1);  // (R, J)
  // The root's distance is 0, where the square root has no gradient.
  const torch::Tensor weight = batch.target_weight.defined() ? known * batch.target_weight : known;
  const torch::Tensor distance = torch::sqrt(squares + 1e-12) * weight;
  Losses losses;
  losses.total = distance.sum() / torch::clamp_min(weight.sum(), 1e-6);
  return losses;
}

Losses MeanLosses(const TrainingSet& set, std::size_t stride,
                  const std::function<Losses(const std::vector<const TrainingFrame*>& frames)>& compute) {
  const torch::NoGradGuard no_grad;
  constexpr std::size_t kChunk = 512;
  constexpr torch::Tensor Losses::*kAll[] = {&Losses::reprojection, &Losses::view, &Losses::camera, &Losses::total};
  Losses mean;
  double count = 0.0;
  std::vector<const TrainingFrame*> frames;
  for (std::size_t n = 0; n < set.frames.size(); n += stride) {
    frames.push_back(&set.frames[n]);
    if (frames.size() < kChunk && n + stride < set.frames.size()) continue;
    const Losses losses = compute(frames);
    const auto weight = static_cast<double>(frames.size());
    for (const auto loss : kAll) {
      if (!(losses.*loss).defined()) continue;
      const torch::Tensor term = (losses.*loss).to(torch::kFloat64) * weight;
      mean.*loss = (mean.*loss).defined() ? mean.*loss + term : term;
    }
    count += weight;
    frames.clear();
  }
  for (const auto loss : kAll) {
    if ((mean.*loss).defined()) mean.*loss = mean.*loss / count;
  }
  return mean;
}

namespace {

/// The mean absolute element of each pair's difference (P, ...), summed with the pairs' weights.
torch::Tensor WeightedDifference(const torch::Tensor& difference, const PairList& pairs) {
  const torch::Tensor weight = torch::tensor(pairs.weight, torch::kFloat64).to(difference.options());
  return (difference.abs().flatten(1).mean(1) * weight).sum();
}

torch::Tensor ViewLoss(const LifterOutput& output, const BatchTensors& batch, const PairList& pairs,
                       const torch::Tensor& perspective, int root, Consistency consistency) {
  const torch::Device device = batch.keypoints.device();
  const torch::Tensor target = IndexTensor(pairs.target, device);
  const torch::Tensor pose = output.pose.index_select(0, IndexTensor(pairs.source, device));
  if (consistency == Consistency::kEqualPoses) {
    return WeightedDifference(pose - output.pose.index_select(0, target), pairs);
  }
  return WeightedError(torch::bmm(output.rotation.index_select(0, target), pose), pairs, batch, target, perspective,
                       root);
}

torch::Tensor CameraLoss(const LifterOutput& output, const torch::Tensor& own, const BatchTensors& batch,
                         const PairList& pairs, const torch::Tensor& perspective, int root, Consistency consistency) {
  if (pairs.size() == 0) return torch::zeros({}, own.options());
  const torch::Device device = batch.keypoints.device();
  const auto relative = [&](const std::vector<std::int64_t>& to, const std::vector<std::int64_t>& from) {
    return torch::bmm(output.rotation.index_select(0, IndexTensor(to, device)),
                      output.rotation.index_select(0, IndexTensor(from, device)).transpose(1, 2));
  };
  const torch::Tensor of_other_frame = relative(pairs.to, pairs.from);
  if (consistency == Consistency::kEqualCameras) {
    return WeightedDifference(relative(pairs.target, pairs.source) - of_other_frame, pairs);
  }
  const torch::Tensor rotated = torch::bmm(of_other_frame, own.index_select(0, IndexTensor(pairs.source, device)));
  return WeightedError(rotated, pairs, batch, IndexTensor(pairs.target, device), perspective, root);
}

}  // namespace

void WeighSeenJointsAlike(BatchTensors& batch) {
  batch.confidence = (batch.confidence > 0).to(batch.confidence.scalar_type());
}

Losses ComputeLosses(const LifterOutput& output, const BatchTensors& batch, const BatchPairs& pairs,
                     const LossWeights& weights, const torch::Tensor& perspective, int root, Consistency consistency) {
  Losses losses;
  const torch::Tensor own = torch::bmm(output.rotation, output.pose);  // (R, 3, J)
  losses.reprojection =
      WeightedError(own, pairs.reprojection, batch, IndexTensor(pairs.reprojection.target, batch.keypoints.device()),
                    perspective, root);
  losses.view = ViewLoss(output, batch, pairs.view, perspective, root, consistency);
  losses.total = weights.reprojection * losses.reprojection + weights.view * losses.view;
  losses.camera = CameraLoss(output, own, batch, pairs.camera, perspective, root, consistency);
  if (pairs.camera.size() > 0) losses.total = losses.total + weights.camera * losses.camera;
  return losses;
}

}  // namespace canonpose
