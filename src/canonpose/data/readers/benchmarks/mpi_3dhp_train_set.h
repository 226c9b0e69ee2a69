// MPI-INF-3DHP, training set: annot.mat of a subject's sequence, and its camera.calibration.
#pragma once

#include "canonpose/data/readers/benchmarks/benchmark.h"

namespace canonpose {

/// Each path is an annot.mat (MATLAB version 5): annot2, cells of 14 cameras (N, 56) px, and annot3 or univ_annot3, 14
/// cells (N, 84) mm in the camera's frame, 28 joints each. There is one sequence per file, named after its folders, "S1
/// Seq1", with cameras "0" to "13" of 2048x2048 pixels. Truth is annot3, whose projection is annot2; univ_annot3 has
/// the same poses scaled to one body height.
///
/// The calibration, which is for one file, is text: a first line, then seven lines per camera (name, sensor, size,
/// animated, intrinsic with 16 numbers, extrinsic with 16, radial). Throws Error(kBadInput).
Dataset ImportMpi3dhpTrain(const BenchmarkOptions& options);

}  // namespace canonpose
