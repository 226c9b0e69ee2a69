// Whether true poses are a person's, the right way round and in millimetres: what a benchmark's layout promises.
#pragma once

#include <string>
#include <vector>

#include "canonpose/data/dataset.h"

namespace canonpose {

struct AnatomyFindings {
  double unit_mm = 1.0;  ///< the truth's unit as its bones tell, 1, 10 (centimetres) or 1000 (metres)
  double stature_mm =
      0.0;  ///< median length of the legs, the trunk and the head together, in `unit_mm`; NaN where it cannot be told
  bool legs_swapped = false;  ///< most knees bend forwards only if left and right legs change places
  bool arms_swapped = false;  ///< shoulders and hips face opposite ways in most poses
};

/// Of the truth of all views. Where the joints cannot tell, nothing is found.
AnatomyFindings ExamineAnatomy(const Dataset& dataset);

/// Multiplies the truth of all views, and translations of their cameras, by `factor`.
void ScaleTruth(Dataset& dataset, double factor);

/// One line a contradiction, for BenchmarkData::warnings.
std::vector<std::string> DescribeContradictions(const AnatomyFindings& findings);

}  // namespace canonpose
