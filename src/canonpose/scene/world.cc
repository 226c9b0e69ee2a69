#include "canonpose/scene/world.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/median.h"
#include "canonpose/base/names.h"
#include "canonpose/geometry/angles.h"
#include "canonpose/scene/body_axis.h"
#include "canonpose/scene/feet.h"
#include "canonpose/scene/stature.h"
#include "canonpose/scene/up_solver.h"
#include "canonpose/skeleton/anthropometry.h"

namespace canonpose {
namespace {

using Evidence = UpSolver::Evidence;

constexpr double kFpsWhereUnknown = 30.0;
/// How level people hold and mount cameras, and how far up or down they point them.
constexpr double kStaticRollRad = RadFromDeg(2.0);
constexpr double kMovingRollRad = RadFromDeg(2.5);
constexpr double kPitchRad = RadFromDeg(25.0);
/// No floor is more level than that.
constexpr double kFloorLevelRad = RadFromDeg(0.3);
/// An upright person's shoulders are above the ankles: how far off a habit, and a single moment, may be.
constexpr double kHabitRad = RadFromDeg(3.0);
constexpr double kMomentRad = RadFromDeg(8.0);
/// The same of the trunk of a person who does not stand.
constexpr double kTrunkHabitRad = RadFromDeg(12.0);
constexpr double kTrunkMomentRad = RadFromDeg(20.0);
/// Moments of a movement that are as far apart as that are independent of each other.
constexpr double kMomentSeconds = 1.0;
constexpr double kFewestStandingSeconds = 0.3;
/// Moving cameras: from how far before and after a frame evidence of its up counts; the longer, the less noise, and the
/// more drift.
constexpr double kWindowSeconds = 2.0;
/// How far the lowest positions of feet are from the floor if none stands still, in statures.
constexpr double kLowestFootDeviation = 0.03;
/// A kind of evidence with a smaller share is not mentioned.
constexpr double kMentionedShare = 0.1;

double FpsOf(const PoseSequence& person) { return person.fps > 0.0 ? person.fps : kFpsWhereUnknown; }

/// Directions of one kind over time.
struct MeanDirection {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  double seconds = 0.0;

  void Add(const Eigen::Vector3d& direction, double duration) {
    sum += direction;
    ++count;
    seconds += duration;
  }
  /// Of the mean, if single directions are off by `moment` and all of them together by `habit`.
  [[nodiscard]] double Deviation(double habit_rad, double moment_rad) const {
    // The length of the mean of unit vectors tells how they scatter: 1 - s^2 / 2 for a small angle s.
    const double scatter = std::sqrt(std::max(0.0, 2.0 * (1.0 - sum.norm() / count)));
    const double moment = std::max(moment_rad, scatter);
    return std::sqrt(habit_rad * habit_rad + moment * moment / std::max(1.0, seconds / kMomentSeconds));
  }
};

// ------------------------------------------------------------------------------------------------- static cameras

/// The static, solved cameras of scenes that share them, each once.
std::vector<const SceneCamera*> SolvedCameras(std::span<const Scene> scenes) {
  std::vector<const SceneCamera*> cameras;
  for (const Scene& scene : scenes) {
    for (const SceneCamera& camera : scene.cameras) {
      if (!camera.used || camera.calibration.empty()) continue;
      if (std::ranges::none_of(cameras, [&](const SceneCamera* one) { return one->name == camera.name; })) {
        cameras.push_back(&camera);
      }
    }
  }
  return cameras;
}

bool Moves(std::span<const Scene> scenes) {
  return std::ranges::any_of(scenes, [](const Scene& scene) {
    return std::ranges::any_of(scene.cameras, [](const SceneCamera& camera) { return camera.calibration.size() > 1; });
  });
}

void AddCamera(const Camera& camera, double roll_rad, UpSolver& solver) {
  const Eigen::Matrix3d& rotation = camera.camera_from_world_rotation;
  solver.AddLevel(Evidence::kCameras, rotation.row(0).transpose(), roll_rad);
  solver.AddUpward(Evidence::kCameras, -rotation.row(1).transpose(), kPitchRad);
}

/// The better of two minima: people, or cameras, may be upside down.
UpSolver::Result SolveFrom(const UpSolver& solver, const Eigen::Vector3d& cameras, const Eigen::Vector3d& people) {
  UpSolver::Result best;
  best.cost = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& start : {cameras, people}) {
    if (!(start.norm() > 0.0)) continue;
    const UpSolver::Result result = solver.Solve(start);
    if (result.cost < best.cost) best = result;
  }
  return best;
}

std::string DescribeUp(const std::array<double, UpSolver::kEvidenceKinds>& shares) {
  constexpr const char* kNames[] = {"cameras held level", "people who stand upright", "feet that stand still"};
  std::vector<std::string> names;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    if (shares[i] >= kMentionedShare) names.emplace_back(kNames[i]);
  }
  return JoinWithAnd(names);
}

/// The feet of everybody whose stature is known, over all scenes.
std::vector<Feet> FeetOf(std::span<const Scene> scenes) {
  std::vector<Feet> all;
  for (const Scene& scene : scenes) {
    for (const PoseSequence& person : scene.people) {
      const std::optional<StatureEstimate> stature = EstimateStature(person);
      if (!stature) continue;
      Feet feet(person, stature->stature);
      if (feet.any()) all.push_back(std::move(feet));
    }
  }
  return all;
}

/// Up and floor, in the coordinates of the scenes.
struct Ground {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  double height = 0.0;  ///< of the floor along `up`, from the origin
  WorldProvenance known;
};

/// The lowest joint of anybody along `up`.
double LowestJoint(std::span<const Scene> scenes, const Eigen::Vector3d& up) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Scene& scene : scenes) {
    for (const PoseSequence& person : scene.people) {
      for (int t = 0; t < person.frame_count(); ++t) {
        const Eigen::VectorXd heights = person.PoseAt(t).cast<double>() * up;
        for (const double height : heights) {
          if (height < lowest) lowest = height;
        }
      }
    }
  }
  return std::isfinite(lowest) ? lowest : 0.0;
}

/// Where no foot stands still: the height that soles hardly ever go below. Nothing where there are no feet.
std::optional<double> LowestSoles(const std::vector<Feet>& feet, const Eigen::Vector3d& up) {
  constexpr double kHardlyEver = 0.02;
  std::vector<double> heights;
  for (const Feet& one : feet) {
    for (int t = 0; t < one.frame_count(); ++t) {
      const double height = one.LowestSole(t, up);
      if (std::isfinite(height)) heights.push_back(height);
    }
  }
  if (heights.empty()) return std::nullopt;
  const auto low = heights.begin() + static_cast<std::ptrdiff_t>(kHardlyEver * static_cast<double>(heights.size()));
  std::ranges::nth_element(heights, low);
  return *low;
}

/// Adds the floor under feet that stand still. What `solver` already holds says roughly which way is up.
UpSolver::Result AddStances(const std::vector<Feet>& feet, const UpSolver& solver, UpSolver::Result result,
                            int& stances_used, double& floor_height) {
  // Which feet are the lower ones depends on up, and up on them.
  constexpr int kRounds = 3;
  stances_used = 0;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Stance> stances;
    for (const Feet& one : feet) {
      const std::vector<Stance> own = one.Stances(result.up);
      stances.insert(stances.end(), own.begin(), own.end());
    }
    if (stances.empty()) break;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const Stance& stance : stances) centre += stance.position / static_cast<double>(stances.size());
    UpSolver with_floor = solver;
    for (const Stance& stance : stances) {
      with_floor.AddFloor(stance.position - centre, stance.height, stance.uncertainty);
    }
    result = with_floor.Solve(result.up);
    stances_used = static_cast<int>(stances.size());
    floor_height = result.floor + result.up.dot(centre);
  }
  return result;
}

std::string DescribeFloor(const std::vector<Feet>& feet, int stances) {
  const bool only_ankles = std::ranges::all_of(feet, [](const Feet& one) { return one.only_ankles(); });
  const std::string what = stances > 0
                               ? fmt::format("{} times that a foot stands still", stances)
                               : std::string("the lowest positions of the feet, because none ever stands still");
  if (!only_ankles) return what;
  return fmt::format("{}; only ankles are known, which are taken to be {:.1f} % of a person's height above the floor",
                     what, 100.0 * kAnkleHeight);
}

Ground FindGround(std::span<const Scene> scenes) {
  UpSolver solver;
  Eigen::Vector3d up_of_cameras = Eigen::Vector3d::Zero();
  for (const SceneCamera* camera : SolvedCameras(scenes)) {
    AddCamera(camera->calibration.front(), kStaticRollRad, solver);
    up_of_cameras -= camera->calibration.front().camera_from_world_rotation.row(1).transpose();
  }
  MeanDirection standing;
  MeanDirection otherwise;
  for (const Scene& scene : scenes) {
    for (const PoseSequence& person : scene.people) {
      const Body body(person);
      for (int t = 0; t < person.frame_count(); ++t) {
        const std::optional<BodyAxis> axis = body.AxisAt(t);
        if (axis) (axis->stands ? standing : otherwise).Add(axis->direction, 1.0 / FpsOf(person));
      }
    }
  }
  const bool anybody_stands = standing.seconds >= kFewestStandingSeconds;
  const MeanDirection& people = anybody_stands ? standing : otherwise;
  if (people.sum.norm() > 0.0) {
    solver.AddUpward(
        Evidence::kPeople, people.sum.normalized(),
        anybody_stands ? people.Deviation(kHabitRad, kMomentRad) : people.Deviation(kTrunkHabitRad, kTrunkMomentRad));
  }
  Ground ground;
  if (solver.empty()) return ground;
  const std::vector<Feet> feet = FeetOf(scenes);
  int stances = 0;
  const UpSolver::Result result =
      AddStances(feet, solver, SolveFrom(solver, up_of_cameras, people.sum), stances, ground.height);
  ground.up = result.up;
  ground.known.up = {DescribeUp(result.shares), DegFromRad(std::hypot(result.deviation_rad, kFloorLevelRad))};
  if (stances > 0) {
    // Feet all stand on the floor in the same way, so that their number does not make it more certain.
    double height_deviation = std::numeric_limits<double>::infinity();
    for (const Feet& one : feet) height_deviation = std::min(height_deviation, one.height_uncertainty());
    ground.known.floor = {DescribeFloor(feet, stances), std::hypot(result.floor_deviation, height_deviation)};
    return ground;
  }
  const std::optional<double> lowest = LowestSoles(feet, ground.up);
  ground.height = lowest.value_or(LowestJoint(scenes, ground.up));
  if (lowest) ground.known.floor = {DescribeFloor(feet, 0), kLowestFootDeviation * feet.front().stature()};
  return ground;
}

// ------------------------------------------------------------------------------------------------- moving cameras

/// Up in every frame, (T), from that frame's cameras and people alone.
std::vector<UpSolver::Result> UpOfFrames(const Scene& scene, int frames) {
  std::vector<Body> bodies;
  for (const PoseSequence& person : scene.people) bodies.emplace_back(person);
  std::vector<UpSolver::Result> results;
  for (int t = 0; t < frames; ++t) {
    UpSolver solver;
    Eigen::Vector3d up_of_cameras = Eigen::Vector3d::Zero();
    for (const SceneCamera& camera : scene.cameras) {
      if (!camera.used || camera.calibration.empty()) continue;
      AddCamera(camera.At(t), kMovingRollRad, solver);
      up_of_cameras -= camera.At(t).camera_from_world_rotation.row(1).transpose();
    }
    Eigen::Vector3d up_of_people = Eigen::Vector3d::Zero();
    for (const Body& body : bodies) {
      const std::optional<BodyAxis> axis = body.AxisAt(t);
      if (!axis) continue;
      solver.AddUpward(Evidence::kPeople, axis->direction,
                       axis->stands ? std::hypot(kHabitRad, kMomentRad) : std::hypot(kTrunkHabitRad, kTrunkMomentRad));
      up_of_people += axis->direction;
    }
    results.push_back(solver.empty() ? UpSolver::Result() : SolveFrom(solver, up_of_cameras, up_of_people));
  }
  return results;
}

/// The same, each from the frames within kWindowSeconds; `deviation_rad` is that of the result.
std::vector<UpSolver::Result> SmoothUp(const std::vector<UpSolver::Result>& frames, double fps) {
  const int count = static_cast<int>(frames.size());
  const int reach = std::max(1, static_cast<int>(std::lround(kWindowSeconds * fps)));
  std::vector<UpSolver::Result> smooth = frames;
  for (int t = 0; t < count; ++t) {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    double weights = 0.0;
    std::array<double, UpSolver::kEvidenceKinds> shares{};
    for (int other = std::max(0, t - reach); other <= std::min(count - 1, t + reach); ++other) {
      const UpSolver::Result& one = frames[static_cast<std::size_t>(other)];
      const double weight = 1.0 - static_cast<double>(std::abs(other - t)) / (reach + 1);
      information += weight * one.information;
      weights += weight;
      for (std::size_t i = 0; i < shares.size(); ++i) shares[i] += weight * one.shares[i];
    }
    // A frame's information is zero along its own up; so their weighted mean is where the sum of all is smallest.
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(information);
    UpSolver::Result& result = smooth[static_cast<std::size_t>(t)];
    const Eigen::Vector3d up = solver.eigenvectors().col(0);
    result.up = up.dot(frames[static_cast<std::size_t>(t)].up) < 0.0 ? -up : up;
    for (std::size_t i = 0; i < shares.size(); ++i) result.shares[i] = shares[i] / weights;
    const double moments = std::max(1.0, weights / fps / kMomentSeconds);
    const Eigen::Vector2d known = solver.eigenvalues().tail<2>() * (moments / weights);
    result.deviation_rad = std::sqrt(1.0 / known.x() + 1.0 / known.y());
  }
  return smooth;
}

// --------------------------------------------------------------------------------------------------------- axes

/// The first used camera's x axis, in the coordinates of the scenes.
Eigen::Vector3d RightOf(std::span<const Scene> scenes) {
  const std::vector<const SceneCamera*> cameras = SolvedCameras(scenes);
  if (cameras.empty()) return Eigen::Vector3d::UnitX();
  return cameras.front()->calibration.front().camera_from_world_rotation.row(0).transpose();
}

/// The rotation to the world whose z axis is `up` and whose x axis is as near to `right` as can be.
Eigen::Matrix3d WorldAxes(const Eigen::Vector3d& up, const Eigen::Vector3d& right) {
  Eigen::Vector3d x = right - right.dot(up) * up;
  if (x.norm() < 1e-6) x = up.unitOrthogonal();
  x.normalize();
  Eigen::Matrix3d rotation;
  rotation.row(0) = x.transpose();
  rotation.row(1) = up.cross(x).transpose();
  rotation.row(2) = up.transpose();
  return rotation;
}

/// Where the first person is first seen, in the world's axes.
Eigen::Vector3d FirstPosition(const Scene& scene, const WorldPlacement& world) {
  for (const PoseSequence& person : scene.people) {
    for (int t = 0; t < person.frame_count(); ++t) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      int count = 0;
      for (int j = 0; j < person.joint_count(); ++j) {
        if (!person.IsKnown(t, j)) continue;
        const Eigen::Vector3d position = person.PoseAt(t).row(j).transpose().cast<double>();
        if (j == person.skeleton().root) return world.Apply(t, position);
        sum += position;
        ++count;
      }
      if (count > 0) return world.Apply(t, sum / count);
    }
  }
  return Eigen::Vector3d::Zero();
}

WorldPlacement FindStaticWorld(std::span<const Scene> scenes) {
  const Ground ground = FindGround(scenes);
  WorldPlacement world;
  world.known = ground.known;
  world.rotations = {WorldAxes(ground.up, RightOf(scenes))};
  world.translation = {0.0, 0.0, -ground.height};
  return world;
}

WorldPlacement FindMovingWorld(const Scene& scene) {
  const int frames = scene.people.empty() ? 0 : scene.people.front().frame_count();
  WorldPlacement world;
  if (frames == 0) {
    world.rotations = {Eigen::Matrix3d::Identity()};
    return world;
  }
  const double fps = FpsOf(scene.people.front());
  const std::vector<UpSolver::Result> up = SmoothUp(UpOfFrames(scene, frames), fps);
  const std::span<const Scene> alone(&scene, 1);
  const Eigen::Matrix3d first = WorldAxes(up.front().up, RightOf(alone));
  std::vector<double> deviations;
  std::array<double, UpSolver::kEvidenceKinds> shares{};
  Eigen::Matrix3d heading = first;
  for (int t = 0; t < frames; ++t) {
    // From frame to frame the axes turn no more than up does.
    const UpSolver::Result& now = up[static_cast<std::size_t>(t)];
    const Eigen::Vector3d& before = up[static_cast<std::size_t>(std::max(0, t - 1))].up;
    heading = heading * Eigen::Quaterniond::FromTwoVectors(now.up, before).toRotationMatrix();
    world.rotations.push_back(WorldAxes(now.up, heading.row(0).transpose()));
    heading = world.rotations.back();
    deviations.push_back(now.deviation_rad);
    for (std::size_t i = 0; i < shares.size(); ++i) shares[i] += now.shares[i] / frames;
  }
  world.known.up = {DescribeUp(shares) + ", frame by frame", DegFromRad(Median(std::move(deviations)))};
  // About where the feet are; that is not the floor of somebody who jumps.
  std::vector<double> soles;
  for (const Feet& feet : FeetOf(alone)) {
    for (int t = 0; t < feet.frame_count(); ++t) {
      const double height = feet.LowestSole(t, world.RotationAt(t).row(2).transpose());
      if (std::isfinite(height)) soles.push_back(height);
    }
  }
  world.translation = {0.0, 0.0, soles.empty() ? 0.0 : -Median(std::move(soles))};
  return world;
}

void RequireMeasures(std::span<const Scene> scenes, const WorldMeasures& measures) {
  if (!measures.heights.empty() && !measures.distances.empty()) {
    ThrowInvalidArgument("`height` and `camera_distance` both say how large the scene is; give one of them");
  }
  CANONPOSE_CHECK(!scenes.empty());
  CANONPOSE_CHECK(scenes.size() == 1 || !Moves(scenes), "{} scenes of moving cameras", scenes.size());
}

std::optional<MeasuredScale> FindScale(std::span<const Scene> scenes, const WorldMeasures& measures) {
  if (!measures.heights.empty()) return ScaleByHeights(scenes, measures.heights);
  if (measures.distances.empty()) return std::nullopt;
  if (Moves(scenes)) {
    ThrowInvalidArgument("`camera_distance`: expected cameras that stand still, but those of {} move; give a height",
                         scenes.front().name);
  }
  return ScaleByDistances(SolvedCameras(scenes), measures);
}

}  // namespace

Camera WorldPlacement::Apply(int frame, const Camera& camera) const {
  Camera placed = camera;
  placed.camera_from_world_rotation = camera.camera_from_world_rotation * RotationAt(frame).transpose();
  placed.camera_from_world_translation =
      scale * camera.camera_from_world_translation - placed.camera_from_world_rotation * translation;
  return placed;
}

WorldPlacement FindWorld(std::span<const Scene> scenes, const WorldMeasures& measures) {
  RequireMeasures(scenes, measures);
  WorldPlacement world = Moves(scenes) ? FindMovingWorld(scenes.front()) : FindStaticWorld(scenes);
  const auto with_people = std::ranges::find_if(scenes, [](const Scene& scene) { return !scene.people.empty(); });
  if (with_people != scenes.end()) world.unit = with_people->people.front().unit;
  world.known.scale = scenes.front().scale;
  if (world.unit != LengthUnit::kMillimetres) {
    if (const std::optional<MeasuredScale> scale = FindScale(scenes, measures)) {
      world.scale = scale->mm_per_unit;
      world.unit = LengthUnit::kMillimetres;
      world.known.scale = scale->known;
    }
  }
  if (world.scale != 1.0 && SolvedCameras(scenes).size() < 3) {
    // Of two cameras the focal lengths are uncertain, and with them the proportions of what they see.
    constexpr double kTwoCamerasPercent = 3.0;
    world.known.scale.uncertainty = std::hypot(world.known.scale.uncertainty, kTwoCamerasPercent);
  }
  world.translation *= world.scale;
  if (std::isfinite(world.known.floor.uncertainty)) world.known.floor.uncertainty *= world.scale;
  const Eigen::Vector3d first = FirstPosition(scenes.front(), world);
  world.translation.head<2>() -= first.head<2>();
  return world;
}

void PlaceInWorld(const WorldPlacement& world, Scene& scene) {
  for (PoseSequence& person : scene.people) {
    for (int t = 0; t < person.frame_count(); ++t) {
      for (int j = 0; j < person.joint_count(); ++j) {
        const Eigen::Vector3d position = person.PoseAt(t).row(j).transpose().cast<double>();
        person.PoseAt(t).row(j) = world.Apply(t, position).cast<float>().transpose();
      }
    }
    for (float& deviation : person.standard_deviation()) deviation *= static_cast<float>(world.scale);
    person.unit = world.unit;
  }
  for (SceneCamera& camera : scene.cameras) {
    // A camera that stands while others move has one calibration in the file, and many in a world that turns.
    const std::size_t frames = camera.calibration.empty() ? 0 : world.rotations.size();
    if (camera.calibration.size() < frames) camera.calibration.resize(frames, camera.calibration.front());
    for (std::size_t t = 0; t < camera.calibration.size(); ++t) {
      camera.calibration[t] = world.Apply(static_cast<int>(t), camera.calibration[t]);
    }
  }
  scene.up = world.known.up;
  scene.floor = world.known.floor;
  scene.scale = world.known.scale;
}

}  // namespace canonpose
