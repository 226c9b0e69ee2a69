// Aligning the cameras of two worlds.
#pragma once

#include <vector>

#include "canonpose/geometry/alignment.h"
#include "canonpose/geometry/camera.h"

namespace canonpose {

/// Solved cameras and the same cameras in truth.
class CameraPairs {
 public:
  void Add(const Camera& solved, const Camera& truth);
  [[nodiscard]] int size() const { return static_cast<int>(solved_.size()); }

  /// The rotation and translation, with scale 1, that take the solved centres to the true ones. Where centres lie on a
  /// line, as two do, the rotation is the one that takes the solved cameras' axes best to the true ones. Needs a pair.
  [[nodiscard]] Similarity Rigid() const;
  /// The same with scale. Needs three pairs to mean anything.
  [[nodiscard]] Similarity WithScale() const;
  /// The mean distance between the centres, after an alignment.
  [[nodiscard]] double MeanDistance(const Similarity& alignment) const;

 private:
  [[nodiscard]] Points3d Centres(const std::vector<Camera>& cameras) const;

  std::vector<Camera> solved_;
  std::vector<Camera> truth_;
};

}  // namespace canonpose
