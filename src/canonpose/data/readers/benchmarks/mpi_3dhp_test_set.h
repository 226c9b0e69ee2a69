// MPI-INF-3DHP, test set: annot_data.mat of TS1 to TS6.
#pragma once

#include "canonpose/data/readers/benchmarks/benchmark.h"

namespace canonpose {

/// Each path is an annot_data.mat (MATLAB version 7.3, which is HDF5): annot2 (N, 1, 17, 2) px, annot3 and univ_annot3
/// (N, 1, 17, 3) mm in the camera's frame, valid_frame (N, 1), activity_annotation (N, 1), possibly with dimensions in
/// reverse order. There is one sequence with one camera per file, named after its folder, "TS1". Truth is univ_annot3
/// unless the options say otherwise, since the field compares with it; it is unknown in frames that are not valid.
/// Images are 2048x2048 pixels, those of TS5 and TS6 1920x1080. Throws Error(kBadInput).
Dataset ImportMpi3dhpTest(const BenchmarkOptions& options);

}  // namespace canonpose
