// From MoveNet's feature maps to poses: what the graph does after its convolutions.
#pragma once

#include <vector>

#include "canonpose/detect/conv_network.h"
#include "canonpose/detect/pose.h"

namespace canonpose {

/// Outputs of the convolutions, all of one size. A cell is `stride` pixels of the network's input wide.
struct PoseMaps {
  FeatureMap heat;        ///< (H, W, 17) before the sigmoid: is the joint here?
  FeatureMap regress;     ///< (H, W, 34) y, x from the centre of a person to each joint, in cells
  FeatureMap centre;      ///< (H, W, 1) before the sigmoid: is the centre of a person here?
  FeatureMap offset;      ///< (H, W, 34) y, x from the cell's corner to each joint, in cells
  FeatureMap box_scale;   ///< (H, W, 2) height, width of the person's box, in cells; for many people only
  FeatureMap box_offset;  ///< (H, W, 2) y, x from the cell's corner to the box's centre, in cells; for many people only
};

/// The one person nearest the middle: the centre is where sigmoid(centre) · centre_weight is largest; each joint where
/// sigmoid(heat) / (distance to where the centre says + 1.8) is. `centre_weight` is (H, W). Positions are fractions of
/// the input, x and y in 0..1; scores are sigmoid(heat). The score of the person is the mean.
DetectedPose DecodeSinglePose(const PoseMaps& maps, const std::vector<float>& centre_weight);

/// Up to six people, the likeliest first: centres are the largest of sigmoid(centre) within 5x5 cells; each joint is
/// where sigmoid(heat) · exp(-distance² / (0.3 · min(H, W))) is largest within the person's box, and its score is that
/// value. Positions as above. The score of the person is that of the centre times the mean of those joints' above
/// 0.127. People with a centre below `least_score` are left out.
std::vector<DetectedPose> DecodePoses(const PoseMaps& maps, float least_score);

}  // namespace canonpose
