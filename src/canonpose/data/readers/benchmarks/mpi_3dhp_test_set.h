// MPI-INF-3DHP, test set: annot_data.mat of TS1 to TS6.
#pragma once

#include "canonpose/data/readers/benchmarks/benchmark.h"

namespace canonpose {

/// Each path an annot_data.mat (MATLAB version 7.3, which is HDF5): annot2 (N, 1, 17, 2) px, annot3 and univ_annot3 (N,
/// 1, 17, 3) mm in the camera's frame, valid_frame (N, 1), activity_annotation (N, 1), all perhaps with their
/// dimensions the other way round. A sequence of one camera per file, "TS1" by its folder. Truth is univ_annot3 unless
/// options say otherwise, since that is what the field compares with; it is unknown in frames that are not valid.
/// Images are 2048x2048 pixels, of TS5 and TS6 1920x1080. Throws Error(kBadInput).
Dataset ImportMpi3dhpTest(const BenchmarkOptions& options);

}  // namespace canonpose
