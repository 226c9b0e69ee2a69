// Training on data that are solved first where they are not solved yet, as preset best does: bootstrap, solve, distil.
#pragma once

#include "canonpose/train/trainer.h"

namespace canonpose {

/// Trains on the 3D poses that the datasets' own views give together (Train() with supervision=solved). Datasets that
/// hold no solved poses yet are solved first, each into the run folder where there is one:
///
///   RUN/bootstrap-N/    the run of a lifter that dataset N was solved from, where the method trained one
///   RUN/solved-N.h5     dataset N with what `solve` found; taken as it is when the run is resumed
///   RUN/solved-N.json   what `solve` tells of it
///
/// Throws as Train(), Bootstrap() and Solve() do.
TrainReport TrainBest(TrainJob job);

}  // namespace canonpose
