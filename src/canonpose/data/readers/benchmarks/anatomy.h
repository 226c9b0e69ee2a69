// What a body says about 3D poses whose file does not: their unit, and whether left and right are what they are called.
#pragma once

#include <string>
#include <vector>

#include "canonpose/skeleton/skeleton.h"

namespace canonpose {

struct PoseUnit {
  double mm_per_unit = 1.0;
  std::string name = "mm";  ///< "mm", "cm" or "m"
  double leg_mm = 0.0;      ///< median length of a leg, hip to ankle; 0 where no frame has one
};

/// The unit of poses (T, J, 3) in joints of `layout`, by the length of legs: 300 to 1300 mm. NaN where unknown. Throws
/// Error(kBadInput) naming file and place where no unit makes them human.
PoseUnit DetectUnit(const Skeleton& layout, const std::vector<float>& poses, const std::string& file,
                  const std::string& place);

/// Says which unit `what` is in, and warns where it is not the mm that it should be.
void ReportUnit(const PoseUnit& unit, const std::string& what);

/// Which limbs are called by the other side's name. Knees bend forward and the nose points there; forward is where
/// somebody looks whose right shoulder is right.
struct SideCheck {
  bool measured = false;  ///< whether enough frames tell anything
  bool arms_swapped = false;
  bool legs_swapped = false;
};

/// Of poses (T, J, 3) in any right-handed frame and unit.
SideCheck CheckSides(const Skeleton& layout, const std::vector<float>& poses);

/// Gathers the checks of many sequences, for one warning a kind rather than one a sequence.
class SideReport {
 public:
  void Add(const SideCheck& sides, const std::string& what);
  /// Warns where left and right are swapped, naming the first sequence and how many more.
  void Warn() const;

 private:
  std::vector<std::string> all_;
  std::vector<std::string> legs_;
  std::vector<std::string> arms_;
};

}  // namespace canonpose
