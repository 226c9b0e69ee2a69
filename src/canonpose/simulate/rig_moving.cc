#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/simulate/rig_parts.h"
#include "canonpose/simulate/smooth_noise.h"

namespace canonpose {
namespace {

/// The middle of the body: operators aim at the pelvis.
const Eigen::Vector3d& Pelvis(const LandmarkTrack& track, int frame) { return track.At(frame, kHip); }

/// Follows a moving point as a hand does. A damped spring pulls towards the point's position and velocity, so that a
/// steady motion is followed without lag, and a change of speed with a lag of about the time constant.
class Follower {
 public:
  Follower(const Eigen::Vector3d& start, double time_constant_seconds, double fps)
      : position_(start), target_(start), rate_(1.0 / time_constant_seconds), fps_(fps) {}

  const Eigen::Vector3d& Next(const Eigen::Vector3d& target) {
    // Small steps keep the spring stable whatever the frame rate.
    const int steps = std::max(1, static_cast<int>(std::ceil(4.0 * rate_ / fps_)));
    const double dt = 1.0 / (fps_ * steps);
    const Eigen::Vector3d speed = (target - target_) * fps_;
    if (first_) velocity_ = speed;
    for (int i = 0; i < steps; ++i) {
      target_ += speed * dt;
      velocity_ += dt * (rate_ * rate_ * (target_ - position_) + 2.0 * rate_ * (speed - velocity_));
      position_ += dt * velocity_;
    }
    target_ = target;
    first_ = false;
    return position_;
  }

 private:
  Eigen::Vector3d position_;
  Eigen::Vector3d target_;
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  double rate_;
  double fps_;
  bool first_ = true;
};

/// A follower that is already following: it starts with the motion of the first two frames.
Follower FollowPelvis(const LandmarkTrack& track, double time_constant_seconds) {
  CANONPOSE_CHECK(track.fps > 0.0, "clip {} has {} frames per second", track.name, track.fps);
  const Eigen::Vector3d& first = Pelvis(track, 0);
  const Eigen::Vector3d step = track.frame_count() > 1 ? (Pelvis(track, 1) - first).eval() : Eigen::Vector3d::Zero();
  Follower follower(first - step, time_constant_seconds, track.fps);
  return follower;
}

/// Grows linearly, then saturates below the limit.
double Limited(double value, double limit) { return limit * std::tanh(value / limit); }

/// Turns a camera so that a point appears at an offset (right and down, as fractions of the image's height) from where
/// a camera aimed at it would show it.
void AimBeside(const Eigen::Vector3d& position_mm, const Eigen::Vector3d& point_mm, const Eigen::Vector2d& offset,
               double focal_px, int image_height_px, double roll_rad, Camera& camera) {
  Aim(position_mm, point_mm, 0.0, camera);
  const double distance = (point_mm - position_mm).norm();
  const Eigen::Vector2d shift_mm = -offset * (image_height_px * distance / focal_px);
  const Eigen::Vector3d target = point_mm + camera.camera_from_world_rotation.topRows<2>().transpose() * shift_mm;
  Aim(position_mm, target, roll_rad, camera);
}

// --- pan, tilt and zoom ---------------------------------------------------------------------------------------------

constexpr double kPtzLagSeconds = 0.2;
/// The range of the person's height in the image, as a fraction of the image's height.
constexpr double kMinFill = 0.25;
constexpr double kMaxFill = 0.60;
constexpr double kFillTimeSeconds = 3.0;
/// Operators' errors: standard deviation and limit, as fractions of the image's height.
constexpr double kPtzAimError = 0.05;
constexpr double kPtzMostOffset = 0.15;
constexpr double kPtzAimTimeSeconds = 0.6;

struct PtzCamera {
  double azimuth_rad;
  double distance_mm;
  double elevation_rad;  ///< of the camera, seen from the subject
  double fill;           ///< 0..1: the operator's preference between kMinFill and kMaxFill
  Lens lens;
};

/// The camera's position beside the course, such that the subject never comes much closer than its distance.
Eigen::Vector3d PlaceOf(const PtzCamera& camera, const LandmarkTrack& track) {
  const Eigen::Vector3d away(std::cos(camera.azimuth_rad), std::sin(camera.azimuth_rad), 0.0);
  double reach = 0.0;
  for (int t = 0; t < track.frame_count(); ++t) reach = std::max(reach, away.dot(Pelvis(track, t)));
  const double distance = std::max(camera.distance_mm, reach + 0.6 * camera.distance_mm);
  return away * distance +
         Eigen::Vector3d(0.0, 0.0, kAimHeightMm + camera.distance_mm * std::tan(camera.elevation_rad));
}

std::vector<Camera> FilmOne(const PtzCamera& ptz, const LandmarkTrack& track, Rng& rng) {
  std::vector<Camera> cameras(static_cast<std::size_t>(track.frame_count()));
  if (cameras.empty()) return cameras;
  const Eigen::Vector3d position = PlaceOf(ptz, track);
  const double stature_mm = StatureMm(&track.At(0, 0));
  Follower follower = FollowPelvis(track, kPtzLagSeconds);
  SmoothNoise error_x(kPtzAimTimeSeconds, track.fps, rng);
  SmoothNoise error_y(kPtzAimTimeSeconds, track.fps, rng);
  SmoothNoise zoom(kFillTimeSeconds, track.fps, rng);
  SmoothNoise roll(2.0, track.fps, rng);
  const int height_px = ptz.lens.image_size[1];
  for (int t = 0; t < track.frame_count(); ++t) {
    Camera& camera = cameras[static_cast<std::size_t>(t)];
    const Eigen::Vector3d& pelvis = Pelvis(track, t);
    const Eigen::Vector3d& followed = follower.Next(pelvis);
    const double liking = std::clamp(ptz.fill + 0.15 * zoom.Next(rng), 0.0, 1.0);
    const double fill = kMinFill + (kMaxFill - kMinFill) * liking;
    const double depth = (followed - position).norm();
    const double focal_px = fill * height_px * depth / stature_mm;
    ptz.lens.Apply(focal_px, camera);
    // Lag and unsteady hands together move the subject off the centre, but only as far as an operator allows.
    Aim(position, followed, 0.0, camera);
    const Eigen::Vector3d seen = camera.InCamera(pelvis);
    const Eigen::Vector2d lag = seen.head<2>() * (focal_px / (seen.z() * height_px));
    const Eigen::Vector2d offset(Limited(lag.x() + kPtzAimError * error_x.Next(rng), kPtzMostOffset),
                                 Limited(lag.y() + kPtzAimError * error_y.Next(rng), kPtzMostOffset / 2.0));
    AimBeside(position, pelvis, offset, focal_px, height_px, RadFromDeg(0.7) * roll.Next(rng), camera);
  }
  return cameras;
}

// --- hand-held ------------------------------------------------------------------------------------------------------

struct HandheldCamera {
  double azimuth_rad;
  double distance_mm;
  double height_mm;
  double orbit_rad_per_second;
  double focal_px;
  Lens lens;
};

/// Moves the operator back from a subject that comes too close or would run into the operator.
void KeepAway(const Eigen::Vector3d& pelvis, double least_mm, double azimuth, Eigen::Vector3d& position) {
  const Eigen::Vector2d away(std::cos(azimuth), std::sin(azimuth));
  const double distance = (position - pelvis).head<2>().dot(away);
  if (distance < least_mm) position.head<2>() += (least_mm - distance) * away;
}

std::vector<Camera> FilmOne(const HandheldCamera& person, const LandmarkTrack& track, Rng& rng) {
  std::vector<Camera> cameras(static_cast<std::size_t>(track.frame_count()));
  if (cameras.empty()) return cameras;
  // The operator walks along with the subject slowly, and turns the camera after it faster.
  Follower walk = FollowPelvis(track, 0.8);
  Follower turn = FollowPelvis(track, 0.15);
  SmoothNoise orbit(2.0, track.fps, rng);
  SmoothNoise nearness(2.5, track.fps, rng);
  SmoothNoise sway(0.7, track.fps, rng);
  SmoothNoise error_x(0.5, track.fps, rng);
  SmoothNoise error_y(0.5, track.fps, rng);
  SmoothNoise shake_x(0.05, track.fps, rng);
  SmoothNoise shake_y(0.05, track.fps, rng);
  SmoothNoise roll(0.8, track.fps, rng);
  const double step_phase = rng.Uniform(0.0, 2.0 * std::numbers::pi);
  for (int t = 0; t < track.frame_count(); ++t) {
    Camera& camera = cameras[static_cast<std::size_t>(t)];
    const double seconds = t / track.fps;
    const double azimuth =
        person.azimuth_rad + person.orbit_rad_per_second * seconds + RadFromDeg(12.0) * orbit.Next(rng);
    const double distance = person.distance_mm * (1.0 + Limited(0.1 * nearness.Next(rng), 0.25));
    // A walker's head bobs at about two steps per second.
    const double bob_mm = 15.0 * std::sin(2.0 * std::numbers::pi * 1.9 * seconds + step_phase);
    const Eigen::Vector3d centre = walk.Next(Pelvis(track, t));
    Eigen::Vector3d position(centre.x() + distance * std::cos(azimuth), centre.y() + distance * std::sin(azimuth),
                             centre.z() - kAimHeightMm + person.height_mm + bob_mm + 40.0 * sway.Next(rng));
    KeepAway(Pelvis(track, t), 0.6 * person.distance_mm, azimuth, position);
    person.lens.Apply(person.focal_px, camera);
    const double distance_now = (Pelvis(track, t) - position).norm();
    // Errors of the aim are angles of the hand: 1.5 degrees slowly, 0.2 degrees of tremor.
    const double height_px = person.lens.image_size[1];
    const double per_radian = person.focal_px / height_px;
    const Eigen::Vector2d offset(
        Limited(per_radian * (RadFromDeg(1.5) * error_x.Next(rng) + RadFromDeg(0.2) * shake_x.Next(rng)), 0.12),
        Limited(per_radian * (RadFromDeg(1.5) * error_y.Next(rng) + RadFromDeg(0.2) * shake_y.Next(rng)), 0.08));
    Eigen::Vector3d followed = turn.Next(Pelvis(track, t));
    const Eigen::Vector3d lag = followed - Pelvis(track, t);
    const double most_lag = 0.1 * height_px * distance_now / person.focal_px;
    if (lag.norm() > 0.0) followed = Pelvis(track, t) + lag * (Limited(lag.norm(), most_lag) / lag.norm());
    AimBeside(position, followed, offset, person.focal_px, person.lens.image_size[1], RadFromDeg(1.5) * roll.Next(rng),
              camera);
  }
  return cameras;
}

// --------------------------------------------------------------------------------------------------------------------

/// Cameras operated by people, of a kind that FilmOne() implements.
template <typename OperatedCamera>
class OperatedRig : public Rig {
 public:
  explicit OperatedRig(std::vector<OperatedCamera> cameras) : cameras_(std::move(cameras)) {}
  [[nodiscard]] bool is_static() const override { return false; }

  [[nodiscard]] std::vector<FilmingCamera> Film(const LandmarkTrack& track, Rng rng) const override {
    std::vector<FilmingCamera> filming;
    for (const OperatedCamera& camera : cameras_) {
      Rng own(rng.Bits());
      filming.push_back(
          {fmt::format("cam{}", filming.size() + 1), camera.lens.image_size, FilmOne(camera, track, own)});
    }
    return filming;
  }

 private:
  std::vector<OperatedCamera> cameras_;
};

}  // namespace

std::unique_ptr<Rig> MakePtzRig(const RigOptions& options, Rng& rng) {
  const int count = options.cameras > 0 ? options.cameras : 6;
  std::vector<PtzCamera> cameras;
  for (const double azimuth : Azimuths(options.spread, count, rng)) {
    PtzCamera camera;
    camera.azimuth_rad = azimuth;
    const double own_m = 10.0 * std::pow(6.0, rng.Uniform());
    camera.distance_mm = 1000.0 * (options.distance_m > 0.0 ? options.distance_m * rng.Uniform(0.7, 1.3) : own_m);
    camera.elevation_rad = RadFromDeg(rng.Uniform(-6.0, 14.0));
    camera.fill = rng.Uniform(0.2, 0.8);
    camera.lens = MakeLens({1920, 1080}, options.distortion, rng);
    cameras.push_back(camera);
  }
  return std::make_unique<OperatedRig<PtzCamera>>(std::move(cameras));
}

std::unique_ptr<Rig> MakeHandheldRig(const RigOptions& options, Rng& rng) {
  constexpr double kOwnDistanceM = 4.5;
  const int count = options.cameras > 0 ? options.cameras : 4;
  const double enlarge = options.distance_m > 0.0 ? options.distance_m / kOwnDistanceM : 1.0;
  std::vector<HandheldCamera> cameras;
  for (const double azimuth : Azimuths(options.spread, count, rng)) {
    HandheldCamera camera;
    camera.azimuth_rad = azimuth;
    camera.distance_mm = 1000.0 * kOwnDistanceM * enlarge * rng.Uniform(0.75, 1.25);
    camera.height_mm = 1000.0 * rng.Uniform(1.3, 1.65);
    camera.orbit_rad_per_second = RadFromDeg(3.0) * rng.Normal();
    // The main lens of a phone, 26 to 30 mm in 35 mm equivalent.
    camera.focal_px = enlarge * 1920.0 * rng.Uniform(26.0, 30.0) / 36.0;
    const bool is_portrait = rng.Uniform() < 0.4;
    const std::array<int, 2> image_size = is_portrait ? std::array{1080, 1920} : std::array{1920, 1080};
    camera.lens = MakeLens(image_size, options.distortion, rng);
    cameras.push_back(camera);
  }
  return std::make_unique<OperatedRig<HandheldCamera>>(std::move(cameras));
}

}  // namespace canonpose
