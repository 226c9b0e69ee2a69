// The depth-reversal ambiguity, and how perspective resolves it: which of two mirror images a trained lifter is.
//
// Under weak perspective a solution (X, R) and its mirror image (F X, F R F), F = diag(1, 1, -1), have the same losses.
// But real cameras have perspective: near parts of the body look larger. Since W = xy / (1 + k z) is about xy (1 - k
// z), the reprojection residual W - q, regressed on z q, has the slope -k < 0 for the right solution and a positive
// slope for its mirror image.
#pragma once

#include <string>
#include <vector>

#include <torch/torch.h>

#include "canonpose/model/lifter.h"
#include "canonpose/model/model_file.h"
#include "canonpose/train/options.h"
#include "canonpose/train/training_set.h"

namespace canonpose {

/// The perspective slope with its standard error over clips.
struct PerspectiveSlope {
  double slope = 0.0;
  double standard_error = 0.0;
  int clips = 0;

  /// |slope| in standard errors.
  [[nodiscard]] double standard_errors() const;
  /// Whether the slope decides the mirror: it is at least `kSure` standard errors from zero, from at least four clips.
  [[nodiscard]] bool is_sure() const;
  [[nodiscard]] bool is_mirrored() const { return slope > 0.0; }
  /// "slope -0.21 +- 0.02 over 16 clips"
  [[nodiscard]] std::string Describe() const;

  static constexpr double kSure = 3.0;
};

/// Least squares over the joints of one clip in all views: residual = slope (z q) + scale q, weighted by confidence.
class SlopeRegression {
 public:
  /// One coordinate of one joint: residual, reprojection q, and depth z relative to the root in units of the pose's
  /// norm.
  void Add(double residual, double reprojection, double depth, double weight);
  /// False, `slope` unchanged, where the data do not determine it.
  bool Solve(double& slope) const;

 private:
  double zz_ = 0.0, zq_ = 0.0, qq_ = 0.0, rz_ = 0.0, rq_ = 0.0;
};

/// Mean and standard error of clips' slopes.
PerspectiveSlope CombineSlopes(const std::vector<double>& slopes);

/// The slope of a lifter on a training set, clip by clip. Poses from one view are compared in the other views: in its
/// own view the network may have distorted the pose to fit the perspective there.
PerspectiveSlope MeasurePerspectiveSlope(LiftingNetwork& lifter, const TrainingSet& set, int root,
                                         torch::Device device);

/// Makes or confirms the decision from a slope, and reports it. A decision that was made before stands unless the slope
/// is sure. Returns whether the network is to be mirrored now.
bool UpdateMirrorDecision(const PerspectiveSlope& slope, MirrorHandling handling, MirrorDecision& decision);

}  // namespace canonpose
