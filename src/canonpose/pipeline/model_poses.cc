#include "canonpose/pipeline/model_poses.h"

#include <string>
#include <utility>

namespace canonpose {

Predictor ModelPoses(const PoseLifter& lifter) {
  return {[&](const Dataset& dataset, const std::string& file) { lifter.RequireSkeleton(dataset.skeleton, file); },
          [&](const Sequence& sequence, std::size_t camera) {
            LiftedPoses poses = lifter.Lift(sequence.cameras[camera], sequence.frame_count);
            return PredictedPoses{std::move(poses.pose_in_camera), std::move(poses.canonical)};
          },
          false,
          "models of preset best: solve again with `mirror=flip` and train on the result; models of presets paper, "
          "paper+c and "
          "plus: train again with `mirror=flip`. If the mirror was flipped already, `mirror=keep` instead"};
}

}  // namespace canonpose
