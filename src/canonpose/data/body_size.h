// How tall the person of some 3D poses is, by which the unit of the poses shows: nobody is 1.7 mm or 17 m tall.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "canonpose/skeleton/skeleton.h"

namespace canonpose {

/// Estimates a person's stature from the lengths of thighs, shanks, upper arms, forearms and the trunk, as shares of
/// the stature (Winter, Biomechanics and Motor Control of Human Movement). It does not matter how the person stands or
/// which of these are known.
class BodySize {
 public:
  explicit BodySize(const Skeleton& skeleton);

  /// Adds poses (T, J, 3) of the skeleton's joints, NaN where unknown.
  void Add(const std::vector<float>& poses);

  /// The median over poses and segments, in the poses' unit. Nothing where the skeleton is not a person's, by the names
  /// of its joints, or no segment is known.
  [[nodiscard]] std::optional<double> Stature() const;

 private:
  struct Segment {
    std::array<int, 2> joints;
    double share;  ///< of the stature
  };

  std::size_t joint_count_;
  std::vector<Segment> segments_;
  std::vector<double> statures_;
};

struct StatureUnit {
  std::string name;  ///< "metres"
  double mm = 1.0;   ///< millimetres per unit
};

/// The statures of people, from a small child's up, in millimetres.
inline constexpr double kMinStatureMm = 500.0;
inline constexpr double kMaxStatureMm = 2700.0;

/// The one of millimetres, centimetres and metres in which `stature` is a person's; nothing where it is in none.
std::optional<StatureUnit> UnitOfStature(double stature);

/// "1.7 mm", "17.3 m": a length in millimetres, for messages.
std::string DescribeLength(double mm);

}  // namespace canonpose
