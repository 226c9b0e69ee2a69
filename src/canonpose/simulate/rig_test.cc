#include "canonpose/simulate/rig.h"

#include <cmath>

#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/geometry/angles.h"
#include "canonpose/simulate/figure_testing.h"

namespace canonpose {
namespace {

using testing::ErrorOf;
using testing::WalkInCircle;

std::vector<FilmingCamera> Film(const RigOptions& options, std::uint64_t seed, const LandmarkTrack& track) {
  return MakeRig(options, Rng(seed))->Film(track, Rng(seed, {1}));
}

Eigen::Vector3d Centre(const Camera& camera) {
  return -camera.camera_from_world_rotation.transpose() * camera.camera_from_world_translation;
}

double AzimuthDegrees(const FilmingCamera& camera) {
  const Eigen::Vector3d centre = Centre(camera.cameras.front());
  return DegFromRad(std::atan2(centre.y(), centre.x()));
}

double AngleBetween(double a, double b) { return std::abs(std::remainder(a - b, 360.0)); }

bool IsInside(const Eigen::Vector2d& pixel, const std::array<int, 2>& size) {
  return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < size[0] && pixel.y() < size[1];
}

/// Fraction of landmarks that are in the images of a rig's cameras.
double ShareInside(const std::vector<FilmingCamera>& filming, const LandmarkTrack& track) {
  int inside = 0;
  int all = 0;
  for (const FilmingCamera& camera : filming) {
    for (int t = 0; t < track.frame_count(); ++t) {
      const Camera& now = camera.cameras[camera.cameras.size() == 1 ? 0 : static_cast<std::size_t>(t)];
      for (int j = 0; j < kLandmarkCount; ++j, ++all) {
        inside += IsInside(now.Project(track.At(t, j)), camera.image_size) ? 1 : 0;
      }
    }
  }
  return static_cast<double>(inside) / all;
}

class RigKinds : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, RigKinds, ::testing::Values("studio", "ring", "ptz", "handheld"));

TEST_P(RigKinds, AreCamerasThatSeeTheSubjectUpright) {
  const LandmarkTrack track = WalkInCircle(200, 25.0, 400.0);
  RigOptions options;
  options.kind = GetParam();
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const std::vector<FilmingCamera> filming = Film(options, seed, track);
    ASSERT_GE(filming.size(), 4U);
    EXPECT_GT(ShareInside(filming, track), 0.97) << "seed " << seed;
    for (const FilmingCamera& camera : filming) {
      for (std::size_t t = 0; t < camera.cameras.size(); ++t) {
        const Camera& now = camera.cameras[t];
        const Eigen::Matrix3d& R = now.camera_from_world_rotation;
        EXPECT_NEAR((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 0.0, 1e-12);
        EXPECT_NEAR(R.determinant(), 1.0, 1e-12);
        const auto frame = static_cast<int>(t);
        EXPECT_LT(now.Project(track.At(frame, kHead)).y(), now.Project(track.At(frame, kRFoot)).y());
      }
    }
  }
}

TEST_P(RigKinds, ShowTheLeftHandOfAPersonFacingTheCameraOnTheRight) {
  RigOptions options;
  options.kind = GetParam();
  LandmarkTrack track = WalkInCircle(2, 25.0, 0.0);
  for (const FilmingCamera& camera : Film(options, 3, track)) {
    const Eigen::Vector3d towards = Centre(camera.cameras.front()) - track.At(0, kHip);
    const Eigen::Vector3d left = Eigen::Vector3d::UnitZ().cross(towards).normalized() * 300.0;
    const Eigen::Vector3d& hip = track.At(0, kHip);
    EXPECT_GT(camera.cameras.front().Project(hip + left).x(), camera.cameras.front().Project(hip - left).x());
  }
}

TEST_P(RigKinds, DifferByCaptureAndRepeatBySeed) {
  const LandmarkTrack track = WalkInCircle(20, 25.0);
  RigOptions options;
  options.kind = GetParam();
  const auto first = Film(options, 1, track);
  const auto again = Film(options, 1, track);
  const auto other = Film(options, 2, track);
  EXPECT_EQ(Centre(first[0].cameras.back()), Centre(again[0].cameras.back()));
  EXPECT_EQ(first[1].cameras.back().K, again[1].cameras.back().K);
  EXPECT_GT((Centre(first[0].cameras.front()) - Centre(other[0].cameras.front())).norm(), 10.0);
}

TEST_P(RigKinds, TakeAnyNumberOfCamerasAndEverySpread) {
  const LandmarkTrack track = WalkInCircle(3, 25.0, 300.0);
  for (const char* spread : {"even", "opposite", "quarter", "clustered"}) {
    for (const int count : {2, 3, 7, 20}) {
      RigOptions options;
      options.kind = GetParam();
      options.spread = spread;
      options.cameras = count;
      EXPECT_EQ(Film(options, 5, track).size(), static_cast<std::size_t>(count));
    }
  }
}

TEST_P(RigKinds, KeepTheRequestedDistanceAndTheSubjectsSize) {
  const LandmarkTrack track = WalkInCircle(10, 25.0, 0.0);
  RigOptions options;
  options.kind = GetParam();
  options.cameras = 60;
  const auto size = [&](const FilmingCamera& camera) {
    const Camera& now = camera.cameras.front();
    return (now.Project(track.At(0, kHead)) - now.Project(track.At(0, kRFoot))).norm() / camera.image_size[1];
  };
  double own_size = 0.0;
  for (const FilmingCamera& camera : Film(options, 7, track)) own_size += size(camera) / 60.0;
  options.distance_m = 12.0;
  double distance = 0.0;
  double far_size = 0.0;
  for (const FilmingCamera& camera : Film(options, 7, track)) {
    distance += Centre(camera.cameras.front()).head<2>().norm() / 60.0;
    far_size += size(camera) / 60.0;
  }
  // A ring's levels have different distances; 12 m is that of the cameras at chest height.
  EXPECT_NEAR(distance, 12000.0, options.kind == std::string("ring") ? 2500.0 : 900.0);
  EXPECT_NEAR(far_size / own_size, 1.0, 0.25);
}

TEST_P(RigKinds, HaveInvertibleDistortion) {
  const LandmarkTrack track = WalkInCircle(30, 25.0);
  RigOptions options;
  options.kind = GetParam();
  options.distortion = 2.0;
  options.cameras = 8;
  for (const FilmingCamera& camera : Film(options, 11, track)) {
    const Camera& now = camera.cameras.back();
    EXPECT_LT(now.distortion[0], 0.0) << "barrel distortion";
    for (const double x : {0.0, camera.image_size[0] / 3.0, camera.image_size[0] * 1.0}) {
      for (const double y : {0.0, camera.image_size[1] / 3.0, camera.image_size[1] * 1.0}) {
        const Eigen::Vector2d normalised = now.Undistort({x, y});
        ASSERT_TRUE(normalised.allFinite()) << camera.name << " " << x << " " << y;
        const Eigen::Vector2d back = (now.K * Distort(normalised, now.distortion).homogeneous()).hnormalized();
        EXPECT_NEAR((back - Eigen::Vector2d(x, y)).norm(), 0.0, 1e-6);
      }
    }
  }
}

TEST(Rig, SpreadsCamerasAsRequested) {
  const LandmarkTrack track = WalkInCircle(1, 25.0, 0.0);
  const auto widest = [&](const char* spread, int count) {
    RigOptions options;
    options.spread = spread;
    options.cameras = count;
    double angle = 0.0;
    const auto filming = Film(options, 9, track);
    for (const auto& a : filming) {
      for (const auto& b : filming) angle = std::max(angle, AngleBetween(AzimuthDegrees(a), AzimuthDegrees(b)));
    }
    return angle;
  };
  EXPECT_LT(widest("quarter", 6), 90.0);
  EXPECT_GT(widest("quarter", 6), 70.0);
  EXPECT_GT(widest("quarter", 2), 70.0);
  EXPECT_LE(widest("quarter", 2), 90.0);
  EXPECT_LT(widest("clustered", 6), 30.0);
  EXPECT_GT(widest("opposite", 2), 155.0);
  RigOptions options;
  options.spread = "opposite";
  const auto filming = Film(options, 9, track);
  EXPECT_LT(AngleBetween(AzimuthDegrees(filming[0]), AzimuthDegrees(filming[2])), 25.0);
  options.spread = "even";
  const auto even = Film(options, 9, track);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(AngleBetween(AzimuthDegrees(even[i]), AzimuthDegrees(even[(i + 1) % 4])), 90.0, 25.0);
  }
}

TEST(Rig, StaticOnesAreTheSameForAllClips) {
  for (const char* kind : {"studio", "ring"}) {
    RigOptions options;
    options.kind = kind;
    const std::unique_ptr<Rig> rig = MakeRig(options, Rng(4));
    EXPECT_TRUE(rig->is_static());
    const auto one = rig->Film(WalkInCircle(5, 25.0), Rng(1));
    const auto two = rig->Film(WalkInCircle(9, 50.0, 1500.0), Rng(2));
    for (std::size_t i = 0; i < one.size(); ++i) {
      ASSERT_EQ(one[i].cameras.size(), 1U);
      EXPECT_EQ(one[i].cameras[0].camera_from_world_rotation, two[i].cameras[0].camera_from_world_rotation);
      EXPECT_EQ(one[i].cameras[0].K, two[i].cameras[0].K);
    }
  }
}

TEST(Rig, RingReachesFromTheFloorToTheCeiling) {
  RigOptions options;
  options.kind = "ring";
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const auto filming = Film(options, seed, WalkInCircle(1, 25.0));
    EXPECT_GE(filming.size(), 8U);
    EXPECT_LE(filming.size(), 14U);
    double lowest = 1e9;
    double highest = 0.0;
    for (const auto& camera : filming) {
      const Camera& now = camera.cameras.front();
      lowest = std::min(lowest, Centre(now).z());
      highest = std::max(highest, Centre(now).z());
      if (Centre(now).z() > 2500.0) {
        EXPECT_LT(now.camera_from_world_rotation(2, 2), -0.5) << "looks down steeply";
      }
    }
    EXPECT_LT(lowest, 950.0);
    EXPECT_GT(highest, 2700.0);
  }
}

TEST(Rig, PtzFollowsASkierAndZoomsWithinItsRange) {
  // 15 m/s down a slope in wide turns, 60 m long.
  LandmarkTrack track = WalkInCircle(200, 50.0, 0.0, 1e9);
  for (int t = 0; t < track.frame_count(); ++t) {
    const double s = t / 50.0 - 2.0;
    const Eigen::Vector3d place(15.0e3 * s, 3.0e3 * std::sin(2.0 * s), -4.0e3 * s);
    for (int j = 0; j < kLandmarkCount; ++j)
      track.positions_mm[static_cast<std::size_t>(t * kLandmarkCount + j)] += place;
  }
  RigOptions options;
  options.kind = "ptz";
  const double stature = StatureMm(&track.At(0, 0));
  double least = 1.0;
  double most = 0.0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const auto filming = Film(options, seed, track);
    EXPECT_GT(ShareInside(filming, track), 0.97) << "seed " << seed;
    for (const FilmingCamera& camera : filming) {
      double off_centre = 0.0;
      for (int t = 0; t < track.frame_count(); ++t) {
        const Camera& now = camera.cameras[static_cast<std::size_t>(t)];
        const double fill = stature * now.K(0, 0) / now.InCamera(track.At(t, kHip)).z() / camera.image_size[1];
        least = std::min(least, fill);
        most = std::max(most, fill);
        const Eigen::Vector2d pixel = now.Project(track.At(t, kHip));
        off_centre = std::max(off_centre, std::abs(pixel.x() - now.K(0, 2)) / camera.image_size[1]);
        if (t > 0) {
          const double before = camera.cameras[static_cast<std::size_t>(t - 1)].K(0, 0);
          EXPECT_NEAR(now.K(0, 0) / before, 1.0, 0.06) << "zooms slowly, at most as fast as the skier approaches";
        }
      }
      EXPECT_LT(off_centre, 0.16);
      EXPECT_GT(off_centre, 0.01);
    }
  }
  EXPECT_GT(least, 0.23);
  EXPECT_LT(most, 0.63);
  EXPECT_GT(most, 0.45);
}

TEST(Rig, PtzStandsBesideTheCourse) {
  RigOptions options;
  options.kind = "ptz";
  options.distance_m = 20.0;
  const LandmarkTrack track = WalkInCircle(400, 25.0, 30.0e3, 16.0);
  for (const FilmingCamera& camera : Film(options, 1, track)) {
    const Eigen::Vector3d place = Centre(camera.cameras.front());
    for (int t = 0; t < track.frame_count(); ++t) {
      EXPECT_GT((track.At(t, kHip) - place).head<2>().norm(), 0.6 * 0.7 * 20.0e3);
      EXPECT_LT((Centre(camera.cameras[static_cast<std::size_t>(t)]) - place).norm(), 1e-6) << "turns on its tripod";
    }
  }
}

TEST(Rig, HandheldShakesAndWalks) {
  RigOptions options;
  options.kind = "handheld";
  const LandmarkTrack track = WalkInCircle(500, 50.0);
  for (const FilmingCamera& camera : Film(options, 2, track)) {
    double walked = 0.0;
    for (std::size_t t = 1; t < camera.cameras.size(); ++t) {
      const double step = (Centre(camera.cameras[t]) - Centre(camera.cameras[t - 1])).norm();
      walked += step;
      EXPECT_LT(step * 50.0, 4000.0) << "no faster than a person, mm/s";
    }
    EXPECT_GT(walked, 500.0);
  }
}

TEST(RigOptions, RefusesInvalidValues) {
  const auto message = [](ErrorKind code, auto&& change) {
    RigOptions options;
    change(options);
    return ErrorOf(code, [&] { options.Validate(); });
  };
  EXPECT_EQ(message(ErrorKind::kBadInput, [](RigOptions& o) { o.cameras = -4; }),
            "`cameras` -4: expected 2 to 1000 cameras, or 0 for the rig's default");
  message(ErrorKind::kBadInput, [](RigOptions& o) { o.cameras = 1; });
  message(ErrorKind::kBadInput, [](RigOptions& o) { o.cameras = 100000; });
  message(ErrorKind::kInvalidArgument, [](RigOptions& o) { o.kind = "studioo"; });
  message(ErrorKind::kInvalidArgument, [](RigOptions& o) { o.spread = "odd"; });
  message(ErrorKind::kInvalidArgument, [](RigOptions& o) { o.distance_m = -1.0; });
  message(ErrorKind::kInvalidArgument, [](RigOptions& o) { o.distance_m = NAN; });
  message(ErrorKind::kInvalidArgument, [](RigOptions& o) { o.distortion = 5.0; });
  message(ErrorKind::kInvalidArgument, [](RigOptions& o) { o.kind = "rig.json", o.cameras = 4; });
}

}  // namespace
}  // namespace canonpose
