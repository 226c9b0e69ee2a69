// How Ceres is called everywhere in solve.
#pragma once

#include <ceres/solver.h>

namespace canonpose {

/// Silent, and on one thread: the same bits whatever the machine; problems are solved side by side instead.
inline ceres::Solver::Options SerialOptions(ceres::LinearSolverType linear_solver, int iterations) {
  ceres::Solver::Options options;
  options.linear_solver_type = linear_solver;
  options.max_num_iterations = iterations;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  return options;
}

}  // namespace canonpose
