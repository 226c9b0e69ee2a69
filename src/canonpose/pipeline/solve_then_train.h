// Training on 3D poses that the recording's own views give: bootstrap, solve, distil (preset best).
#pragma once

#include "canonpose/train/trainer.h"

namespace canonpose {

/// Train() with supervision=solved. Datasets that have not been solved yet are solved first, all together: captures of
/// one name are one capture, whichever datasets they are in. What is found is kept in the run folder:
///
///   RUN/bootstrap/      the run of the lifter that they were solved from, where one was trained for them
///   RUN/solved-N.h5     dataset N with what `solve` found; reused when the run is resumed
///   RUN/solved.json     the report
///
/// Throws as Train(), Bootstrap() and Solve() do, and Error(kComputation) where which way round depth is remained a
/// guess (SolveReport::Doubt()).
TrainReport SolveThenTrain(TrainJob job);

}  // namespace canonpose
