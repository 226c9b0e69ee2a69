// Which way is up, and where the floor is, by weighing evidence of different kinds.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

namespace canonpose {

/// Finds the unit vector u, and the floor's height f along it, that minimise
///
///   sum of rho(axis . u / s)                          axes that should be level, off by the angle s
///     + sum of rho(|direction - u| / s)               directions that should point up
///     + sum of rho((u . point - height - f) / s)      points that should be at a height above the floor
///
/// where rho is Cauchy's loss, so that a camera on its side or a person who lies does not count for much. Gauss-Newton
/// with reweighting, from a given direction.
class UpSolver {
 public:
  enum class Evidence { kCameras, kPeople, kFeet };
  static constexpr int kEvidenceKinds = 3;

  /// Angles in radians, vectors of length 1.
  void AddLevel(Evidence kind, const Eigen::Vector3d& axis, double deviation_rad);
  void AddUpward(Evidence kind, const Eigen::Vector3d& direction, double deviation_rad);
  void AddFloor(const Eigen::Vector3d& point, double height, double deviation);

  [[nodiscard]] bool empty() const { return terms_.empty(); }

  struct Result {
    Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    double floor = 0.0;          ///< only with AddFloor()
    double deviation_rad = 0.0;  ///< root mean square of the angle between `up` and the truth, by the terms'
                                 ///< deviations, and by how they disagree
    double floor_deviation = 0.0;
    double cost = 0.0;
    /// Of the floor eliminated: 1 / rad^2, zero along `up`.
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    std::array<double, kEvidenceKinds> shares{};  ///< of each kind of evidence in the information about `up`
  };
  [[nodiscard]] Result Solve(const Eigen::Vector3d& start) const;

 private:
  enum class Form { kLevel, kUpward, kFloor };
  struct Term {
    Form form;
    Evidence kind;
    Eigen::Vector3d vector;
    double height;
    double deviation;
  };
  /// The size of a term's residual, in deviations.
  [[nodiscard]] static double Residual(const Term& term, const Eigen::Vector3d& up, double floor);

  std::vector<Term> terms_;
};

}  // namespace canonpose
