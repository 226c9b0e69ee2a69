#include "canonpose/data/calibration_check.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/random.h"
#include "canonpose/base/testing.h"
#include "canonpose/data/ring_testing.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using testing::CollectedMessages;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::PersonInRing;

void Exchange(Dataset& dataset, std::size_t a, std::size_t b) {
  std::vector<CameraView>& cameras = dataset.sequences.front().cameras;
  std::swap(cameras[a].calibration, cameras[b].calibration);
}

void Scale(Dataset& dataset, double factor) {
  for (CameraView& view : dataset.sequences.front().cameras) {
    for (Camera& camera : view.calibration) camera.camera_from_world_translation *= factor;
    for (float& value : view.truth.positions()) value = static_cast<float>(value * factor);
  }
}

TEST(CheckCalibration, HasNothingToSayOfTheRightOne) {
  Dataset dataset = PersonInRing();
  Rng rng(3);
  for (CameraView& view : dataset.sequences.front().cameras) {
    for (float& value : view.keypoints) value += static_cast<float>(6.0 * rng.Normal());
  }
  const CalibrationFit fit = MeasureCalibration(dataset.sequences.front(), 17);
  EXPECT_TRUE(fit.fits());
  EXPECT_TRUE(fit.interchanged.empty());
  EXPECT_NEAR(fit.error_px, 6.0, 4.0);
  const CollectedMessages messages;
  CheckCalibration(dataset, "data.h5");
  EXPECT_EQ(messages.text(), "");
}

TEST(CheckCalibration, NamesCamerasThatAreInterchanged) {
  for (const int cameras : {2, 3, 4, 5, 7}) {
    for (int a = 0; a < cameras; ++a) {
      Dataset dataset = PersonInRing(cameras);
      const auto first = static_cast<std::size_t>(a);
      const std::size_t second = (first + 1) % static_cast<std::size_t>(cameras);
      Exchange(dataset, first, second);
      const std::string error = ErrorOf(ErrorKind::kBadInput, [&] { CheckCalibration(dataset, "data.h5"); });
      EXPECT_THAT(error, AllOf(HasSubstr("data.h5: calibration: "), HasSubstr("interchanged"),
                               HasSubstr("c" + std::to_string(a)), HasSubstr("c" + std::to_string(second))));
    }
  }
}

TEST(CheckCalibration, NamesThreeCamerasWhoseCalibrationsWentRound) {
  Dataset dataset = PersonInRing();
  Exchange(dataset, 0, 1);
  Exchange(dataset, 1, 2);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { CheckCalibration(dataset, "data.h5"); }),
              AllOf(HasSubstr("under the name c0"), HasSubstr("under the name c1"), HasSubstr("under the name c2")));
}

TEST(CheckCalibration, WarnsOfAnotherRecordings) {
  Dataset dataset = PersonInRing();
  for (std::size_t c = 0; c < 4; ++c) {
    Camera& camera = dataset.sequences.front().cameras[c].calibration.front();
    camera.camera_from_world_translation.y() += c % 2 == 0 ? 500.0 : -500.0;
  }
  const CollectedMessages messages;
  CheckCalibration(dataset, "data.h5");
  EXPECT_THAT(messages.text(), HasSubstr("warning: data.h5: the calibration does not fit the keypoints of walk"));
}

TEST(CheckCalibration, ReadsMetresAndCentimetresAsSuch) {
  const Dataset right = PersonInRing();
  for (const auto& [factor, unit] : {std::pair(0.001, "metres"), {0.1, "centimetres"}}) {
    Dataset dataset = PersonInRing();
    Scale(dataset, factor);
    const CollectedMessages messages;
    CheckCalibration(dataset, "data.h5");
    EXPECT_THAT(messages.text(), HasSubstr(std::string("data.h5: the calibration's t is in ") + unit));
    const Camera& camera = dataset.sequences.front().cameras[2].calibration.front();
    const Camera& expected = right.sequences.front().cameras[2].calibration.front();
    EXPECT_LT((camera.camera_from_world_translation - expected.camera_from_world_translation).norm(), 1e-6);
  }
}

TEST(CheckCalibration, RefusesAPersonOfSeventeenMetres) {
  Dataset dataset = PersonInRing();
  Scale(dataset, 10.0);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { CheckCalibration(dataset, "data.h5"); }),
              AllOf(HasSubstr("data.h5"), HasSubstr("500 mm to 2.7 m"), HasSubstr("found one of 17.")));
}

TEST(CheckCalibration, LeavesBodiesThatAreNotPeopleAlone) {
  Dataset dataset = PersonInRing();
  for (std::size_t j = 0; j < dataset.skeleton.joints.size(); ++j)
    dataset.skeleton.joints[j] = fmt::format("Part{}", j);
  Scale(dataset, 10.0);
  const CollectedMessages messages;
  CheckCalibration(dataset, "data.h5");
  CheckUnitOfTruth(dataset, "data.h5");
  EXPECT_EQ(messages.text(), "");
}

TEST(CheckUnitOfTruth, ReadsMetresAsSuch) {
  const Dataset right = PersonInRing();
  Dataset dataset = right;
  Scale(dataset, 0.001);
  const CollectedMessages messages;
  CheckUnitOfTruth(dataset, "data.h5");
  EXPECT_THAT(messages.text(), AllOf(HasSubstr("the truth is in metres"), HasSubstr("1.7")));
  EXPECT_NEAR(dataset.sequences[0].cameras[1].truth.positions()[7], right.sequences[0].cameras[1].truth.positions()[7],
              0.01);
  Scale(dataset, 10.0);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { CheckUnitOfTruth(dataset, "data.h5"); }),
              HasSubstr("truth in millimetres"));
}

}  // namespace
}  // namespace canonpose
