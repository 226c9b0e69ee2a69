// Who belongs to whom at the least cost.
#pragma once

#include <vector>

namespace canonpose {

/// For each row of costs (N rows of M), the column that it is assigned to; -1 where leaving it alone, at the cost
/// `alone`, is cheaper. No column is assigned twice, and the sum of all costs is the least possible (Kuhn 1955). Costs
/// must be finite.
std::vector<int> AssignAtLeastCost(const std::vector<std::vector<double>>& costs, double alone);

}  // namespace canonpose
