#include "canonpose/train/triangulated_targets.h"

#include <utility>

#include "canonpose/data/sequence_triangulation.h"

namespace canonpose {

void LearnFromTriangulation(Dataset& dataset) {
  for (Sequence& sequence : dataset.sequences) {
    SequencePoses triangulated = TriangulateSequence(sequence, dataset.skeleton);
    for (std::size_t c = 0; c < sequence.cameras.size(); ++c) {
      CameraView& view = sequence.cameras[c];
      view.solved = std::move(triangulated.poses_in_camera[c]);
      view.solved_calibration = view.calibration;
    }
  }
}

}  // namespace canonpose
