#include "canonpose/geometry/interpolation.h"

namespace canonpose {

std::array<double, 4> CubicWeights(double share) {
  const double s = share;
  const double s2 = s * s;
  const double s3 = s2 * s;
  return {0.5 * (-s3 + 2.0 * s2 - s), 0.5 * (3.0 * s3 - 5.0 * s2 + 2.0), 0.5 * (-3.0 * s3 + 4.0 * s2 + s),
          0.5 * (s3 - s2)};
}

std::array<double, 4> LinearWeights(double share) { return {0.0, 1.0 - share, share, 0.0}; }

}  // namespace canonpose
