// Training on 3D poses that the recording's own views give: bootstrap, solve, distil (preset best).
#pragma once

#include "canonpose/train/trainer.h"

namespace canonpose {

/// Train() with supervision=solved. Datasets that have not been solved yet are solved first, each into the run folder:
///
///   RUN/bootstrap-N/    the run of the lifter that dataset N was solved from, where one was trained for it
///   RUN/solved-N.h5     dataset N with what `solve` found; reused when the run is resumed
///   RUN/solved-N.json   its report
///
/// Throws as Train(), Bootstrap() and Solve() do.
TrainReport SolveThenTrain(TrainJob job);

}  // namespace canonpose
