// Shared by the tests of benchmarks: importing with the log, and comparing with what the script that made the files
// (testdata/make_benchmarks.py) computed independently.
#pragma once

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/data/codecs/npz.h"
#include "canonpose/data/readers/benchmarks/anatomy.h"
#include "canonpose/data/readers/benchmarks/benchmark.h"

namespace canonpose::testing {

inline constexpr double kTolerance = 1e-3;  // mm and px

inline std::filesystem::path File(const std::string& name) { return TestData("benchmarks") / name; }

inline BenchmarkOptions Options(const std::string& format, const std::vector<std::string>& files) {
  BenchmarkOptions options;
  options.format = format;
  for (const std::string& file : files)
    options.paths.push_back(std::filesystem::path(file).is_absolute() ? std::filesystem::path(file) : File(file));
  return options;
}

struct Imported {
  Dataset dataset;
  std::string log;
};

inline Imported Import(const BenchmarkOptions& options) {
  const CollectedMessages messages;
  Imported imported;
  imported.dataset = ImportBenchmark(options);
  imported.log = messages.text();
  return imported;
}

inline std::string Refusal(const BenchmarkOptions& options, ErrorKind kind = ErrorKind::kBadInput) {
  return ErrorOf(kind, [&] { Import(options); });
}

inline const Sequence& Find(const Dataset& dataset, const std::string& name) {
  for (const Sequence& sequence : dataset.sequences) {
    if (sequence.name == name) return sequence;
  }
  ADD_FAILURE() << "no sequence " << name;
  return dataset.sequences.front();
}

inline const CameraView& Find(const Sequence& sequence, const std::string& camera) {
  for (const CameraView& view : sequence.cameras) {
    if (view.name == camera) return view;
  }
  ADD_FAILURE() << "no camera " << camera;
  return sequence.cameras.front();
}

inline void ExpectNear(const std::vector<float>& found, const std::filesystem::path& file, const std::string& key,
                       double tolerance = kTolerance) {
  std::vector<std::size_t> shape;
  const std::vector<float> expected = NpzReader(file).ReadFloats(key, &shape);
  ASSERT_EQ(found.size(), expected.size()) << key;
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_EQ(std::isnan(found[i]), std::isnan(expected[i])) << key << " " << i;
    if (std::isnan(found[i])) continue;
    ASSERT_NEAR(found[i], expected[i], tolerance) << key << " " << i;
  }
}

/// Checks that the truth of a calibrated view projects to its keypoints.
inline void ExpectTruthProjects(const CameraView& view, int frames, double tolerance_px) {
  const std::size_t joints = view.confidence.size() / static_cast<std::size_t>(frames);
  const std::vector<float>& truth = view.truth.positions();
  for (std::size_t i = 0; i < view.confidence.size(); ++i) {
    if (std::isnan(truth[3 * i])) continue;
    const Camera& camera = view.CalibrationAt(static_cast<int>(i / joints));
    const Eigen::Vector2d pixel = camera.ProjectFromCamera({truth[3 * i], truth[3 * i + 1], truth[3 * i + 2]});
    ASSERT_NEAR(pixel.x(), view.keypoints[2 * i], tolerance_px) << view.name << " " << i;
    ASSERT_NEAR(pixel.y(), view.keypoints[2 * i + 1], tolerance_px) << view.name << " " << i;
  }
}

inline void ExpectRightIsRight(const Dataset& dataset, const CameraView& view) {
  const SideCheck sides = CheckSides(dataset.skeleton, view.truth.positions());
  EXPECT_TRUE(sides.measured);
  EXPECT_FALSE(sides.arms_swapped || sides.legs_swapped);
}

}  // namespace canonpose::testing
