#include "canonpose/data/codecs/mat_file.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/data/codecs/npz.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;
using testing::TestData;

constexpr const char* kFile = "benchmarks/3dhp_train/S1/Seq1/annot.mat";

TEST(MatFile, ReadsCellsInRowMajorOrder) {
  const MatFile file(TestData(kFile));
  const std::vector<Matrix> cells = file.ReadCells("annot2", 14);
  ASSERT_EQ(cells.size(), 14U);
  // Camera 7's keypoints, of which the benchmark's 17 joints were written to the .npz file by NumPy; 4 is the pelvis.
  std::vector<std::size_t> shape;
  const std::vector<float> expected =
      NpzReader(TestData("benchmarks/3dhp_train/expected.npz")).ReadFloats("S1 Seq1|7|keypoints", &shape);
  const Matrix& cell = cells[7];
  ASSERT_EQ(cell.rows, shape.front());
  ASSERT_EQ(cell.columns, 2 * 28U);
  ASSERT_EQ(cell.values.size(), cell.rows * cell.columns);
  const std::size_t row = expected.size() / shape.front();
  for (std::size_t t = 0; t < cell.rows; ++t) {
    EXPECT_NEAR(cell.values[t * cell.columns + 2 * 4], expected[t * row], 1e-3) << t;
    EXPECT_NEAR(cell.values[t * cell.columns + 2 * 4 + 1], expected[t * row + 1], 1e-3) << t;
  }
}

TEST(MatFile, MissingVariablesAreNamedWithTheAdvice) {
  const MatFile file(TestData(kFile), "ask the author");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { (void)file.ReadCells("annot9", 14); }),
              AllOf(HasSubstr("annot9: expected a variable of that name"), HasSubstr("ask the author")));
  EXPECT_THAT(
      ErrorOf(ErrorKind::kBadInput, [&] { (void)file.ReadCells("annot2", 13); }),
      AllOf(HasSubstr("annot2: expected a cell array of 13 matrices, found 14 cells"), HasSubstr("ask the author")));
}

TEST(MatFile, OtherFormatsAndDamagedFilesAreRefused) {
  const auto error = [](const std::filesystem::path& path) {
    return ErrorOf(ErrorKind::kBadInput, [&] { MatFile(path, "ask the author"); });
  };
  EXPECT_THAT(error("/nonexistent/a.mat"), HasSubstr("check the path"));
  EXPECT_THAT(error(TestData("benchmarks/3dhp_test/TS1/annot_data.mat")),
              AllOf(HasSubstr("version 7.3"), HasSubstr("ask the author")));
  EXPECT_THAT(error(TestData("mocap/tiny.bvh")), AllOf(HasSubstr("another format"), HasSubstr("ask the author")));
  const TemporaryFolder folder;
  const std::string bytes = ReadFile(TestData(kFile));
  WriteFileAtomically(folder / "cut.mat", bytes.substr(0, bytes.size() - 9));
  EXPECT_THAT(error(folder / "cut.mat"), HasSubstr("cut short or damaged"));
}

}  // namespace
}  // namespace canonpose
