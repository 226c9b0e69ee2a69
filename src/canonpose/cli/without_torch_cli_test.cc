// The program without LibTorch: it simulates, solves from a factorisation and evaluates, and says that networks are
// missing.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/cli/program_testing.h"
#include "canonpose/data/dataset.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using testing::Execute;
using ::testing::HasSubstr;
using testing::Outcome;
using testing::TemporaryFolder;

TEST(ProgramWithoutTorch, SolvesFromAFactorisationAndEvaluates) {
  const TemporaryFolder folder;
  ASSERT_EQ(Execute({"simulate", "-o", folder / "data.h5", "--subjects", "1", "--clips", "1", "--activities", "dance",
                     "--seconds", "8", "--fps", "15"})
                .exit_code,
            0);
  const Outcome solved = Execute({"solve", folder / "data.h5", "-o", folder / "solved.h5"});
  ASSERT_EQ(solved.exit_code, 0) << solved.errors;
  EXPECT_TRUE(ReadDataset(folder / "solved.h5").HasSolved());
  const Outcome evaluated = Execute({"evaluate", folder / "solved.h5"});
  EXPECT_EQ(evaluated.exit_code, 0) << evaluated.errors;
  EXPECT_THAT(evaluated.output, HasSubstr("N-MPJPE"));
}

TEST(ProgramWithoutTorch, SaysThatNetworksAreMissing) {
  for (const char* command : {"detect", "train", "train-morph", "lift"}) {
    const Outcome outcome = Execute({command, "data.h5", "-o", "run"});
    EXPECT_EQ(outcome.exit_code, 2) << outcome.errors;
    EXPECT_THAT(outcome.errors, AllOf(HasSubstr(command), HasSubstr("CANONPOSE_WITH_TORCH=ON")));
  }
}

}  // namespace
}  // namespace canonpose
