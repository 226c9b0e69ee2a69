// What somebody who mistyped a name may have meant.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace canonpose {

/// The name that `word` is a slip of: the beginning of a single name, or the fewest letters away that were missed,
/// added, exchanged for another or swapped with their neighbour, one in three at most. The first of several; none where
/// nothing is near. Case does not matter.
std::optional<std::string> NearestName(std::string_view word, const std::vector<std::string>& names);

}  // namespace canonpose
