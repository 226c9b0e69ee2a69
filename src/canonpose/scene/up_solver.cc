#include "canonpose/scene/up_solver.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "canonpose/base/median.h"

namespace canonpose {
namespace {

constexpr double kCauchyScale = 2.0;  ///< deviations
constexpr int kIterations = 30;
/// Keeps what no term determines where it is; radians, and the unit of the points.
constexpr double kFaint = 1e-6;

/// In the parameters (a, b, f): up + a e1 + b e2, and the floor.
struct NormalEquations {
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  void Add(const Eigen::Vector3d& jacobian, double residual, double weight) {
    hessian += weight * jacobian * jacobian.transpose();
    gradient += weight * residual * jacobian;
  }
};

/// Two unit vectors that are perpendicular to `up` and to each other.
Eigen::Matrix<double, 3, 2> TangentOf(const Eigen::Vector3d& up) {
  Eigen::Matrix<double, 3, 2> tangent;
  tangent.col(0) = up.unitOrthogonal();
  tangent.col(1) = up.cross(tangent.col(0));
  return tangent;
}

}  // namespace

void UpSolver::AddLevel(Evidence kind, const Eigen::Vector3d& axis, double deviation_rad) {
  terms_.push_back({Form::kLevel, kind, axis, 0.0, deviation_rad});
}

void UpSolver::AddUpward(Evidence kind, const Eigen::Vector3d& direction, double deviation_rad) {
  terms_.push_back({Form::kUpward, kind, direction, 0.0, deviation_rad});
}

void UpSolver::AddFloor(const Eigen::Vector3d& point, double height, double deviation) {
  terms_.push_back({Form::kFloor, Evidence::kFeet, point, height, deviation});
}

double UpSolver::Residual(const Term& term, const Eigen::Vector3d& up, double floor) {
  switch (term.form) {
    case Form::kLevel:
      return term.vector.dot(up) / term.deviation;
    case Form::kUpward:
      return (term.vector - up).norm() / term.deviation;
    case Form::kFloor:
      return (up.dot(term.vector) - term.height - floor) / term.deviation;
  }
  return 0.0;
}

UpSolver::Result UpSolver::Solve(const Eigen::Vector3d& start) const {
  Result result;
  result.up = start.normalized();
  std::vector<double> floors;
  for (const Term& term : terms_) {
    if (term.form == Form::kFloor) floors.push_back(result.up.dot(term.vector) - term.height);
  }
  const bool has_floor = !floors.empty();
  if (has_floor) result.floor = Median(std::move(floors));

  Eigen::Matrix<double, 3, 2> tangent;
  NormalEquations all;
  std::array<double, kEvidenceKinds> traces{};
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    tangent = TangentOf(result.up);
    all = {};
    traces = {};
    for (const Term& term : terms_) {
      const double residual = Residual(term, result.up, result.floor);
      const double weight = 1.0 / (1.0 + residual * residual / (kCauchyScale * kCauchyScale));
      NormalEquations own;
      const auto add = [&](const Eigen::Vector3d& along, double value, double of_floor) {
        const Eigen::Vector2d slope = tangent.transpose() * along / term.deviation;
        own.Add({slope.x(), slope.y(), of_floor}, value, weight);
      };
      if (term.form == Form::kUpward) {
        for (int i = 0; i < 2; ++i) add(tangent.col(i), -tangent.col(i).dot(term.vector) / term.deviation, 0.0);
      } else {
        add(term.vector, residual, term.form == Form::kFloor ? -1.0 / term.deviation : 0.0);
      }
      all.hessian += own.hessian;
      all.gradient += own.gradient;
      traces[static_cast<std::size_t>(term.kind)] += own.hessian(0, 0) + own.hessian(1, 1);
    }
    // Points at one place say nothing of the direction, however far from the origin they are: what the floor takes up
    // is not information.
    all.hessian.diagonal().array() += kFaint;
    if (!has_floor) all.hessian(2, 2) = 1.0;
    const Eigen::Vector3d step = -all.hessian.ldlt().solve(all.gradient);
    result.up = (result.up + tangent * step.head<2>()).normalized();
    result.floor += step.z();
    if (step.head<2>().norm() < 1e-9) break;
  }
  double squares = 0.0;
  for (const Term& term : terms_) {
    const double residual = Residual(term, result.up, result.floor) / kCauchyScale;
    result.cost += kCauchyScale * kCauchyScale * std::log1p(residual * residual);
    squares += kCauchyScale * kCauchyScale * residual * residual / (1.0 + residual * residual);
  }
  // Terms that disagree by more than their deviations are less certain than these say.
  const double freedom = std::max(1.0, static_cast<double>(terms_.size()) - (has_floor ? 3.0 : 2.0));
  const Eigen::Matrix3d covariance = std::max(1.0, squares / freedom) * all.hessian.inverse();
  result.deviation_rad = std::sqrt(covariance(0, 0) + covariance(1, 1));
  result.floor_deviation = has_floor ? std::sqrt(covariance(2, 2)) : std::nan("");
  const Eigen::Matrix2d information = all.hessian.inverse().topLeftCorner<2, 2>().inverse();
  result.information = tangent * information * tangent.transpose();
  // The feet's share is what is left of theirs after the floor is eliminated.
  auto& of_feet = traces[static_cast<std::size_t>(Evidence::kFeet)];
  of_feet = std::max(0.0, of_feet - (all.hessian.topLeftCorner<2, 2>() - information).trace());
  const double sum = traces[0] + traces[1] + traces[2];
  for (std::size_t i = 0; i < traces.size(); ++i) result.shares[i] = sum > 0.0 ? traces[i] / sum : 0.0;
  return result;
}

}  // namespace canonpose
