// What anatomy reveals about 3D poses where their file does not say: their unit, and whether left and right are named
// correctly.
#pragma once

#include <string>
#include <vector>

#include "canonpose/skeleton/skeleton.h"

namespace canonpose {

struct PoseUnit {
  double mm_per_unit = 1.0;
  std::string name = "mm";  ///< "mm", "cm" or "m"
  double leg_mm = 0.0;      ///< median length of a leg, hip to ankle; 0 if no frame has one
};

/// The unit of poses (T, J, 3) with the joints of `layout`, NaN where unknown. It is the unit that makes legs 300 to
/// 1300 mm long. Throws Error(kBadInput) that names file and place where no unit does.
PoseUnit DetectUnit(const Skeleton& layout, const std::vector<float>& poses, const std::string& file,
                    const std::string& place);

/// Logs the unit of `what`, and warns where it is not mm, as it should be.
void ReportUnit(const PoseUnit& unit, const std::string& what);

/// Which limbs have the other side's name. Knees bend forward and the nose points forward, and left and right of a
/// person follow from where forward is.
struct SideCheck {
  bool measured = false;  ///< whether enough frames could be used
  bool arms_swapped = false;
  bool legs_swapped = false;
};

/// Checks poses (T, J, 3) in any right-handed frame and unit.
SideCheck CheckSides(const Skeleton& layout, const std::vector<float>& poses);

/// Collects the checks of many sequences, for one warning per kind instead of one per sequence.
class SideReport {
 public:
  void Add(const SideCheck& sides, const std::string& what);
  /// Warns where left and right are swapped; names the first sequence and how many more there are.
  void Warn() const;

 private:
  std::vector<std::string> all_;
  std::vector<std::string> legs_;
  std::vector<std::string> arms_;
};

}  // namespace canonpose
