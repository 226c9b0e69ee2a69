// The losses of the method: confidence-weighted reprojection errors of poses and rotations mixed over views and frames.
//
// Wandt et al., CanonPose, CVPR 2021, equations 3 to 7. Every loss is a weighted sum over pairs p of
//
//   l(p) = 1/(2J) sum_j c_tj ( |dx_j| + |dy_j| ),   d = W_t / |W_t| - q / |q|,   q = Project(M_p X_s)
//
// with s the row (a view of a frame) whose pose is used, t the row it is compared with, M_p the rotation that takes it
// there, and
// |.| = sqrt(sum of squares / 2J) over the joints seen in t. What differs between the losses is which pairs, rotations
// and weights.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <torch/torch.h>

#include "canonpose/base/random.h"
#include "canonpose/model/lifter.h"
#include "canonpose/train/options.h"
#include "canonpose/train/training_set.h"

namespace canonpose {

/// Pairs of one loss, as indices of batch rows. All vectors are equally long.
struct PairList {
  std::vector<std::int64_t> source;  ///< row whose canonical pose is used
  std::vector<std::int64_t> target;  ///< row it is compared with
  std::vector<double> weight;        ///< weight of the pair in the loss
  /// Camera consistency only: the pose is first turned into view `source` by its own rotation, then by the relative
  /// rotation R[to] * R[from]^T of another frame. Empty otherwise, where the rotation is that of `target`.
  std::vector<std::int64_t> to;
  std::vector<std::int64_t> from;

  [[nodiscard]] std::size_t size() const { return source.size(); }
};

/// All pairs of a batch.
struct BatchPairs {
  PairList reprojection;  ///< each row with itself; mean over rows
  PairList view;          ///< mean over frames, sum over source views, mean over the other views
  PairList camera;        ///< sum over captures and source views, mean over frames and the other views
};

/// For every capture of the batch with more than one frame, every source camera and every window, in that order: the
/// permutation of the capture's frames in the batch that lie in the window (by their order in the batch).
using DrawPermutation = std::function<std::vector<std::size_t>(std::size_t count)>;

/// The pairs of `frames` (whose rows are numbered 0 .. in the order of frames and views: row numbers of the batch, not
/// of the set). Views that are missing leave out the pairs they would take part in. Camera pairs are made where
/// `static_captures` allows and `with_camera_loss` asks for them. `windows`, where it is given, has the number of a
/// window for each of `frames`: camera pairs then join frames of one window alone, and cameras may move.
BatchPairs MakeBatchPairs(const std::vector<const TrainingFrame*>& frames,
                          const std::vector<std::uint8_t>& static_captures, bool with_camera_loss,
                          const DrawPermutation& draw_permutation, const std::vector<std::int64_t>& windows = {});

/// Makes a row of a batch another; `set_row` is its number in the set.
using RowChange = std::function<void(int set_row, const TrainingRow& row)>;

/// Rows of a batch on the device.
struct BatchTensors {
  torch::Tensor keypoints;   ///< (R, 2, J)
  torch::Tensor confidence;  ///< (R, J)
  torch::Tensor target;  ///< (R, 3, J) root-centred, of unit norm, NaN where unknown; undefined where the set has none
  torch::Tensor target_weight;  ///< (R, J); undefined where all joints count the same
};

/// The rows of `frames`, in the order MakeBatchPairs() numbers them. `change`, where there is one, is called for every
/// row in that order, with its number in the set and its copy in the batch, to make it another.
BatchTensors GatherBatch(const TrainingSet& set, const std::vector<const TrainingFrame*>& frames, torch::Device device,
                         const RowChange& change = {});

struct LossWeights {
  double reprojection = 1.0;
  double view = 1.0;
  double camera = 0.1;
};

/// The losses and their weighted sum; scalars. `camera` is 0 without camera pairs. With supervision there is `total`
/// alone.
struct Losses {
  torch::Tensor reprojection;
  torch::Tensor view;
  torch::Tensor camera;
  torch::Tensor total;
};

/// The lifter's input: (R, 3J) planar keypoints, then confidences.
torch::Tensor LifterInput(const BatchTensors& batch);

/// Projection of poses in the camera, (P, 3, J) -> (P, 2, J): weak perspective, q = xy, where `perspective` is
/// undefined; otherwise q = xy / (1 + k z) with k the given scalar and z the depth relative to the root joint in units
/// of the root-centred pose's Frobenius norm. 1 + k z is kept above 0.1.
torch::Tensor Project(const torch::Tensor& pose_in_camera, const torch::Tensor& perspective, int root);

/// l(p) of the formula above, (P): `projected` is q (P, 2, J); keypoints W (P, 2, J); confidence (P, J).
torch::Tensor PairErrors(const torch::Tensor& projected, const torch::Tensor& keypoints,
                         const torch::Tensor& confidence);

/// The loss of supervised training, scale-free as N-MPJPE is: the mean distance of joints, weighted where the
/// batch has weights, between P / |P| and the target, P the pose in the camera centred on the root, |.| the Frobenius
/// norm over the joints whose target is known.
Losses ComputeSupervisedLoss(const LifterOutput& output, const BatchTensors& batch, int root);

/// The mean over every `stride`-th frame of a set of `compute`, the losses of some frames; without gradients.
Losses MeanLosses(const TrainingSet& set, std::size_t stride,
                  const std::function<Losses(const std::vector<const TrainingFrame*>& frames)>& compute);

/// Gives all joints that are seen the confidence 1.
void WeighSeenJointsAlike(BatchTensors& batch);

Losses ComputeLosses(const LifterOutput& output, const BatchTensors& batch, const BatchPairs& pairs,
                     const LossWeights& weights, const torch::Tensor& perspective, int root,
                     Consistency consistency = Consistency::kMixing);

}  // namespace canonpose
