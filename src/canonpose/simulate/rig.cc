#include "canonpose/simulate/rig.h"

#include <cmath>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/simulate/rig_parts.h"

namespace canonpose {
namespace {

constexpr int kMaxCameras = 1000;

Eigen::Vector3d Around(double azimuth_rad, double distance_mm, double height_mm) {
  return {distance_mm * std::cos(azimuth_rad), distance_mm * std::sin(azimuth_rad), height_mm};
}

/// A camera that a person has aimed at the middle of the subject's volume: roughly there, and roughly level.
FilmingCamera MakeStatic(const std::string& name, const Eigen::Vector3d& position_mm, double focal_px, const Lens& lens,
                         Rng& rng) {
  Camera camera;
  lens.Apply(focal_px, camera);
  const Eigen::Vector3d target(80.0 * rng.Normal(), 80.0 * rng.Normal(), kAimHeightMm + 60.0 * rng.Normal());
  Aim(position_mm, target, RadFromDeg(1.0) * rng.Normal(), camera);
  return {name, lens.image_size, {camera}};
}

std::unique_ptr<Rig> MakeStudioRig(const RigOptions& options, Rng& rng) {
  constexpr double kOwnDistanceM = 5.0;
  constexpr double kFocalPx = 1145.0;
  const int count = options.cameras > 0 ? options.cameras : 4;
  const double enlarge = options.distance_m > 0.0 ? options.distance_m / kOwnDistanceM : 1.0;
  std::vector<FilmingCamera> cameras;
  for (const double azimuth : Azimuths(options.spread, count, rng)) {
    const double distance_mm = 1000.0 * kOwnDistanceM * enlarge * rng.Uniform(0.8, 1.2);
    const Eigen::Vector3d position = Around(azimuth, distance_mm, 1000.0 * rng.Uniform(1.3, 1.8));
    const Lens lens = MakeLens({1000, 1000}, options.distortion, rng);
    const double focal_px = kFocalPx * enlarge * rng.Uniform(0.99, 1.01);
    cameras.push_back(MakeStatic(fmt::format("cam{}", cameras.size() + 1), position, focal_px, lens, rng));
  }
  return std::make_unique<StaticRig>(std::move(cameras));
}

/// One level of the ring: heights and distances in metres, focal length in pixels.
struct RingLevel {
  double low_m;
  double high_m;
  double near_m;
  double far_m;
  double focal_px;
};

std::unique_ptr<Rig> MakeRingRig(const RigOptions& options, Rng& rng) {
  // Chest height, ceiling, chest height, near the floor, and so on around the ring. The closer the camera, the wider
  // its lens.
  static constexpr RingLevel kLevels[] = {{1.0, 1.7, 3.2, 4.2, 1500.0},
                                          {2.8, 3.3, 1.8, 2.8, 1050.0},
                                          {1.0, 1.7, 3.2, 4.2, 1500.0},
                                          {0.6, 0.9, 3.0, 4.0, 1300.0}};
  constexpr double kOwnDistanceM = 3.7;
  const int count = options.cameras > 0 ? options.cameras : 8 + static_cast<int>(rng.Index(7));
  const double enlarge = options.distance_m > 0.0 ? options.distance_m / kOwnDistanceM : 1.0;
  std::vector<FilmingCamera> cameras;
  for (const double azimuth : Azimuths(options.spread, count, rng)) {
    const RingLevel& level = kLevels[cameras.size() % std::size(kLevels)];
    const double height_mm = 1000.0 * rng.Uniform(level.low_m, level.high_m);
    const double distance_mm = 1000.0 * enlarge * rng.Uniform(level.near_m, level.far_m);
    const Lens lens = MakeLens({2048, 2048}, options.distortion, rng);
    const double focal_px = level.focal_px * enlarge * rng.Uniform(0.97, 1.03);
    cameras.push_back(MakeStatic(fmt::format("cam{}", cameras.size() + 1), Around(azimuth, distance_mm, height_mm),
                                 focal_px, lens, rng));
  }
  return std::make_unique<StaticRig>(std::move(cameras));
}

bool IsBuiltinKind(const std::string& kind) {
  return kind == "studio" || kind == "ring" || kind == "ptz" || kind == "handheld";
}

}  // namespace

bool RigOptions::IsFile() const {
  return !IsBuiltinKind(kind) && (kind.ends_with(".json") || kind.find('/') != std::string::npos);
}

void RigOptions::Validate() const {
  if (cameras < 0 || cameras == 1 || cameras > kMaxCameras) {
    throw Error(ErrorKind::kBadInput, fmt::format("`cameras` {}: expected 2 to {} cameras, or 0 for the rig's default",
                                                  cameras, kMaxCameras));
  }
  if (!IsBuiltinKind(kind) && !IsFile()) {
    ThrowInvalidArgument("there is no `rig` {}; choose studio, ring, ptz, handheld or a JSON file", kind);
  }
  if (spread != "even" && spread != "opposite" && spread != "quarter" && spread != "clustered") {
    ThrowInvalidArgument("there is no `spread` {}; choose even, opposite, quarter or clustered", spread);
  }
  if (!(distance_m == 0.0 || (distance_m >= 1.0 && distance_m <= 1000.0))) {
    ThrowInvalidArgument("`distance` {} is out of range; give 1 to 1000 m, or 0 for the rig's default", distance_m);
  }
  if (!(distortion >= 0.0 && distortion <= 2.0))
    ThrowInvalidArgument("`distortion` {} is out of range; give 0 to 2", distortion);
  if (IsFile() && (cameras != 0 || spread != "even" || distance_m != 0.0 || distortion != 0.0)) {
    ThrowInvalidArgument(
        "`rig` {} already defines its cameras; leave out `cameras`, `spread`, `distance` and `distortion`", kind);
  }
}

std::unique_ptr<Rig> MakeRig(const RigOptions& options, Rng rng) {
  options.Validate();
  if (options.kind == "studio") return MakeStudioRig(options, rng);
  if (options.kind == "ring") return MakeRingRig(options, rng);
  if (options.kind == "ptz") return MakePtzRig(options, rng);
  if (options.kind == "handheld") return MakeHandheldRig(options, rng);
  return ReadRigFile(options.kind);
}

}  // namespace canonpose
