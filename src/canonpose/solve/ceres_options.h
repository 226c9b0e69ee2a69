// The options with which solve calls Ceres everywhere.
#pragma once

#include <ceres/solver.h>

namespace canonpose {

/// Silent and on one thread, so that results have the same bits on every machine. Problems run in parallel instead.
inline ceres::Solver::Options SerialOptions(ceres::LinearSolverType linear_solver, int iterations) {
  ceres::Solver::Options options;
  options.linear_solver_type = linear_solver;
  options.max_num_iterations = iterations;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  return options;
}

}  // namespace canonpose
