// Points in space, such as the joints of a pose.
#pragma once

#include <Eigen/Core>

namespace canonpose {

/// (N, 3), one point per row.
using Points3d = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

}  // namespace canonpose
