// The losses: those of the method (mixing), the supervised one, and the batches they are computed on.
//
// The method's are confidence-weighted reprojection errors of poses and rotations that are exchanged between views and
// frames (Wandt et al., CanonPose, CVPR 2021, equations 3 to 7). Each is a weighted sum over pairs p of the error
//
//   l(p) = 1/(2J) sum_j c_tj ( |dx_j| + |dy_j| ),   d = W_t / |W_t| - q / |q|,   q = Project(M_p X_s)
//
//   s    the row (a view of a frame) whose canonical pose X_s is used
//   t    the row whose keypoints W_t and confidences c_t it is compared with
//   M_p  the rotation from the canonical pose into that view
//   |.|  sqrt(sum of squares / 2J) over the joints that are seen in t
//
// The losses differ in their pairs, rotations and weights:
//
//   loss          s and t                    M_p
//   reprojection  the same row               R_s
//   view          two views of a frame       R_t
//   camera        two views of a frame       R_to R_from^T R_s; `to`, `from`: the same views of another frame
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
  /// Camera consistency only: the rows whose relative rotation R[to] R[from]^T takes the pose from view `source` to
  /// view `target`. Empty otherwise, where the rotation is that of `target`.
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

/// Called for every capture with more than one frame in the batch, every source camera and every window, in that order:
/// a permutation of the capture's frames that lie in the window, which says from which frame each gets its rotations.
using DrawPermutation = std::function<std::vector<std::size_t>(std::size_t count)>;

/// The pairs of `frames`. Rows are numbered from 0 in the order of frames and views: they are rows of the batch, not of
/// the set. Pairs with a missing view are left out. Camera pairs are made if `with_camera_loss`, for captures with
/// static cameras. `windows`, if given, has the number of a window for each frame: camera pairs are then made within
/// windows, and cameras may move.
BatchPairs MakeBatchPairs(const std::vector<const TrainingFrame*>& frames,
                          const std::vector<std::uint8_t>& static_captures, bool with_camera_loss,
                          const DrawPermutation& draw_permutation, const std::vector<std::int64_t>& windows = {});

/// Changes a row of a batch in place; `set_row` is its number in the set.
using RowChange = std::function<void(int set_row, const TrainingRow& row)>;

/// Rows of a batch on the device.
struct BatchTensors {
  torch::Tensor keypoints;   ///< (R, 2, J)
  torch::Tensor confidence;  ///< (R, J)
  torch::Tensor target;  ///< (R, 3, J) root-centred, of unit norm, NaN where unknown; undefined where the set has none
  torch::Tensor target_weight;  ///< (R, J); undefined where all joints count the same
};

/// The rows of `frames`, in the order in which MakeBatchPairs() numbers them. `change`, if given, is called for every
/// row in that order, with its number in the set and its copy in the batch.
BatchTensors GatherBatch(const TrainingSet& set, const std::vector<const TrainingFrame*>& frames, torch::Device device,
                         const RowChange& change = {});

struct LossWeights {
  double reprojection = 1.0;
  double view = 1.0;
  double camera = 0.1;
};

/// The losses and their weighted sum, scalars on the device. `camera` is 0 without camera pairs. Supervised losses have
/// a `total` alone; the others are undefined.
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

/// The loss of supervised training: the mean distance of joints, weighted if the batch has weights, between P / |P| and
/// the target. P is the pose in the camera, centred on the root, and |.| the Frobenius norm over the joints whose
/// target is known. Like N-MPJPE it does not depend on scale.
Losses ComputeSupervisedLoss(const LifterOutput& output, const BatchTensors& batch, int root);

/// The mean over every `stride`-th frame of a set, in double; `compute` returns the losses of some frames. Without
/// gradients, and without waiting for the device.
Losses MeanLosses(const TrainingSet& set, std::size_t stride,
                  const std::function<Losses(const std::vector<const TrainingFrame*>& frames)>& compute);

/// Sets the confidence of all joints that are seen to 1.
void WeighSeenJointsAlike(BatchTensors& batch);

/// The losses of the method for a batch. `perspective` as in Project().
Losses ComputeLosses(const LifterOutput& output, const BatchTensors& batch, const BatchPairs& pairs,
                     const LossWeights& weights, const torch::Tensor& perspective, int root,
                     Consistency consistency = Consistency::kMixing);

}  // namespace canonpose
