// `evaluate` from the user's side: figures against an independent computation, files, and what is refused.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/cli/program_testing.h"
#include "canonpose/data/codecs/npz.h"
#include "canonpose/data/dataset.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using testing::Execute;
using testing::ExpectBadInput;
using ::testing::HasSubstr;
using testing::Outcome;
using testing::TemporaryFolder;
using testing::TestData;

json Evaluated(std::vector<std::string> arguments) {
  const TemporaryFolder folder;
  arguments.insert(arguments.begin(), "evaluate");
  arguments.insert(arguments.end(), {"--json", folder / "report.json"});
  const Outcome outcome = Execute(arguments);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  return outcome.exit_code == 0 ? json::parse(ReadFile(folder / "report.json")) : json::object();
}

/// Everything expected is there and agrees to 0.01 (mm, or %).
void ExpectNear(const json& found, const json& expected, const std::string& where) {
  constexpr double kTolerance = 0.01;
  if (expected.is_object()) {
    for (const auto& [key, value] : expected.items()) {
      ASSERT_TRUE(found.contains(key)) << where << ": " << key;
      ExpectNear(found[key], value, fmt::format("{} {}", where, key));
    }
  } else if (expected.is_array()) {
    ASSERT_EQ(found.size(), expected.size()) << where;
    for (std::size_t i = 0; i < expected.size(); ++i) ExpectNear(found[i], expected[i], fmt::format("{} {}", where, i));
  } else {
    EXPECT_NEAR(found.get<double>(), expected.get<double>(), kTolerance) << where;
  }
}

/// A copy of a dataset of testdata/protocols with a change.
template <typename Change>
void WriteChanged(const fs::path& path, const std::string& name, Change change) {
  Dataset dataset = ReadDataset(TestData("protocols/" + name));
  change(dataset);
  WriteDataset(path, dataset);
}

TEST(EvaluateProgram, AgreesWithNumPyInEveryFigureOfEveryProtocol) {
  const json cases = json::parse(ReadFile(TestData("protocols/expected.json")));
  ASSERT_EQ(cases.size(), 7U);
  for (const json& one : cases) {
    const std::string file = one["file"];
    const std::string protocol = one["protocol"];
    const json found = Evaluated({TestData("protocols/" + file), "--protocol", protocol});
    ASSERT_TRUE(found.is_object());
    EXPECT_EQ(found["protocol_name"], protocol);
    EXPECT_THAT(found["protocol"].get<std::string>(), ::testing::StartsWith(protocol + ": "));
    ExpectNear(found, one["figures"], fmt::format("{} by {}:", file, protocol));
    for (const char* group : {"per_sequence", "per_joint", "per_action"}) {
      EXPECT_EQ(found.contains(group), one["figures"].contains(group)) << file << group;
      if (!found.contains(group)) continue;
      EXPECT_EQ(found[group].size(), one["figures"][group].size()) << file << group;
    }
    EXPECT_TRUE(found["warnings"].empty()) << found["warnings"];
  }
}

TEST(EvaluateProgram, ListsProtocolsAndRefusesOthers) {
  const Outcome listed = Execute({"evaluate", "--list-protocols"});
  EXPECT_EQ(listed.exit_code, 0);
  EXPECT_THAT(listed.output, AllOf(HasSubstr("h36m-1: "), HasSubstr("skipose: "), HasSubstr("means over actions")));
  const TemporaryFolder folder;
  ASSERT_EQ(Execute({"evaluate", "--list-protocols", "--json", folder / "list.json"}).exit_code, 0);
  const json list = json::parse(ReadFile(folder / "list.json"))["protocols"];
  ASSERT_EQ(list.size(), 5U);
  EXPECT_EQ(list[0]["name"], "all-frames");
  EXPECT_TRUE(list[0]["truth_kind"].is_null());
  EXPECT_EQ(list[3]["name"], "3dhp");
  EXPECT_EQ(list[3]["truth_kind"], "univ_annot3");
  EXPECT_EQ(list[3]["pck"]["joints"].size(), 14U);
  EXPECT_EQ(list[3]["headline"], "pck150_percent");
  const std::string data = TestData("protocols/3dhp.h5");
  const Outcome unknown = Execute({"evaluate", data, "--protocol", "h36m"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.message(), HasSubstr("the protocols are all-frames, h36m-1, h36m-2, 3dhp, skipose"));
  ExpectBadInput({"evaluate", data, "--protocol", "h36m-1"},
                 AllOf(HasSubstr("3dhp.h5"), HasSubstr("S9 and S11"), HasSubstr("found TS1, TS2")));
  ExpectBadInput({"evaluate", TestData("protocols/h36m.h5"), "--protocol", "h36m-1", "--frames", "1-63"},
                 HasSubstr("frames 0, 64, 128"));
}

TEST(EvaluateProgram, TruthOfAnotherOrUnknownKindIsReportedWithAWarning) {
  const TemporaryFolder folder;
  EXPECT_EQ(Evaluated({TestData("protocols/3dhp.h5"), "--protocol", "3dhp"})["truth_kind"], "univ_annot3");
  const std::string file = folder / "changed.h5";
  for (const char* kind : {"annot3", ""}) {
    WriteChanged(file, "3dhp.h5", [&](Dataset& dataset) {
      for (Sequence& sequence : dataset.sequences) sequence.truth_kind = kind;
    });
    const json report = Evaluated({file, "--protocol", "3dhp"});
    EXPECT_EQ(report.contains("truth_kind"), !std::string(kind).empty());
    ASSERT_EQ(report["warnings"].size(), 1U);
    EXPECT_THAT(report["warnings"][0].get<std::string>(),
                AllOf(HasSubstr("univ_annot3"), HasSubstr(*kind != 0 ? "this is annot3" : "do not say")));
    EXPECT_TRUE(Evaluated({file})["warnings"].empty());
  }
}

TEST(EvaluateProgram, WarnsOfWhatAProtocolMisses) {
  const TemporaryFolder folder;
  const std::string whole = TestData("protocols/h36m.h5");
  EXPECT_TRUE(Evaluated({whole, "--protocol", "h36m-1"})["warnings"].empty());
  Dataset dataset = ReadDataset(whole);
  std::erase_if(dataset.sequences, [](const Sequence& sequence) { return sequence.subject == "S11"; });
  WriteDataset(folder / "s9.h5", dataset);
  EXPECT_THAT(Evaluated({folder / "s9.h5", "--protocol", "h36m-1"})["warnings"].dump(),
              HasSubstr("the data have no truth of S11"));
  dataset = ReadDataset(whole);
  for (Sequence& sequence : dataset.sequences) {
    if (sequence.subject == "S9") sequence.cameras.front().truth = {};
  }
  WriteDataset(folder / "less.h5", dataset);
  EXPECT_THAT(Evaluated({folder / "less.h5", "--protocol", "h36m-1"})["warnings"].dump(),
              HasSubstr("views have no truth and are left out"));
}

TEST(EvaluateProgram, FramesAreCountedFromTheFilesFirst) {
  const std::string data = TestData("protocols/h36m.h5");
  const TemporaryFolder folder;
  const json whole = Evaluated({data, "--protocol", "h36m-1"});
  const json later =
      Evaluated({data, "--protocol", "h36m-1", "--frames", "60-130", "--frame-errors", folder / "e.csv"});
  EXPECT_EQ(whole["left_out_sequences"], 1);
  EXPECT_LT(later["frames"], whole["frames"]);
  const std::string csv = ReadFile(folder / "e.csv");
  EXPECT_THAT(csv, AllOf(HasSubstr("S9_Walking,54138969,64,"), HasSubstr(",128,")));
  EXPECT_THAT(csv, ::testing::Not(HasSubstr(",0,Walking")));
}

TEST(EvaluateProgram, FrameErrorsGiveTheFiguresAgain) {
  const std::string data = TestData("protocols/skipose.h5");
  const TemporaryFolder folder;
  const json report = Evaluated({data, "--protocol", "skipose", "--frame-errors", folder / "errors.npz"});
  const NpzReader reader(folder / "errors.npz");
  std::vector<std::size_t> shape;
  double sum = 0.0;
  int count = 0;
  for (const float error : reader.ReadFloats("n_error_mm", &shape)) {
    if (std::isnan(error)) continue;
    sum += error;
    ++count;
  }
  EXPECT_EQ(shape[0], report["frames"].get<std::size_t>());
  EXPECT_EQ(shape[1], 17U);
  EXPECT_NEAR(sum / count, report["n_mpjpe_mm"].get<double>(), 0.001);
  EXPECT_EQ(Execute({"evaluate", data, "--frame-errors", folder / "errors.txt"}).exit_code, 2);
}

TEST(EvaluateProgram, ArchivesTakeOnlyTheDefaultProtocol) {
  const TemporaryFolder folder;
  NpzWriter writer(folder / "poses.npz");
  std::vector<float> poses(2 * 5 * 3);
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i] = static_cast<float>(i * i % 17);
  writer.Add("pose3d", poses, {2, 5, 3});
  writer.Commit();
  const std::string file = folder / "poses.npz";
  const Outcome refused = Execute({"evaluate", "--predictions", file, "--truth", file, "--protocol", "h36m-2"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.message(), HasSubstr("only all-frames makes sense"));
  const json report = Evaluated({"--predictions", file, "--truth", file, "--frame-errors", folder / "errors.csv"});
  EXPECT_EQ(report["frames"], 2);
  EXPECT_THAT(ReadFile(folder / "errors.csv"), HasSubstr("poses,,1,,0.0000"));
}

TEST(EvaluateProgram, TriangulationNeedsTruthAndCalibration) {
  const TemporaryFolder folder;
  ExpectBadInput({"evaluate", "--triangulate", TestData("protocols/h36m.h5")},
                 AllOf(HasSubstr("h36m.h5"), HasSubstr("calibrated")));
  const std::string exact = folder / "exact.h5";
  ASSERT_EQ(Execute({"simulate", "-o", exact, "--subjects", "1", "--clips", "1", "--seconds", "1", "--fps", "10",
                     "--noise", "0"})
                .exit_code,
            0);
  const json report = Evaluated({"--triangulate", exact});
  EXPECT_LT(report["n_mpjpe_mm"], 0.1) << "exact pixels";
  EXPECT_EQ(report["missing_predictions"], 0);
  EXPECT_EQ(report["reference"], "truth");
  Dataset dataset = ReadDataset(exact);
  for (CameraView& view : dataset.sequences.front().cameras) view.truth = {};
  WriteDataset(folder / "blind.h5", dataset);
  ExpectBadInput({"evaluate", "--triangulate", folder / "blind.h5"}, HasSubstr("truth"));
}

TEST(EvaluateProgram, OnlyModelsHaveCanonicalPoses) {
  const TemporaryFolder folder;
  const std::string data = folder / "data.h5";
  ASSERT_EQ(
      Execute({"simulate", "-o", data, "--subjects", "1", "--clips", "1", "--seconds", "2", "--fps", "10"}).exit_code,
      0);
  ASSERT_EQ(
      Execute({"train", data, "-o", folder / "run", "--width", "16", "--epochs", "1", "--threads", "1"}).exit_code, 0);
  const json report = Evaluated({folder / "run", data, "--canonical"});
  const json& canonical = report["canonical"];
  EXPECT_GT(canonical["hip_std_mm"]["RHip"], 0.0);
  EXPECT_EQ(canonical["hip_std_mm"]["LHip"], canonical["per_joint"]["LHip"]["std_mm"]);
  EXPECT_EQ(canonical["per_joint"]["Hip"]["std_mm"], 0.0) << "the root is the origin";
  EXPECT_GT(canonical["views_mm"], 0.0);
  EXPECT_GT(canonical["frames_mm"], 0.0);
  EXPECT_EQ(Execute({"evaluate", TestData("protocols/h36m.h5"), "--canonical"}).exit_code, 2);
  ASSERT_EQ(
      Execute({"train", data, "-o", folder / "martinez", "--preset", "martinez", "--width", "16", "--epochs", "1"})
          .exit_code,
      0);
  EXPECT_EQ(Execute({"evaluate", folder / "martinez", data, "--canonical"}).exit_code, 2);
  EXPECT_EQ(Execute({"evaluate", data, "--triangulate", "--canonical"}).exit_code, 2);
  EXPECT_EQ(Execute({"evaluate", folder / "run", data, "--triangulate"}).exit_code, 2);
}

TEST(EvaluateProgram, ReportOfSeveralMethods) {
  if (std::system("python3 -c pass") != 0) GTEST_SKIP() << "there is no python3";
  const TemporaryFolder folder;
  const std::string data = TestData("protocols/h36m.h5");
  for (const char* protocol : {"h36m-1", "all-frames"}) {
    ASSERT_EQ(Execute({"evaluate", data, "--protocol", protocol, "--json", folder / protocol}).exit_code, 0);
  }
  const auto report = [&](const std::string& arguments) {
    return std::system(
        fmt::format("cd {} && {}/report {} >out 2>&1", folder.path().string(), CANONPOSE_EXPERIMENTS, arguments)
            .c_str());
  };
  ASSERT_EQ(report("ours=h36m-1 ours=h36m-1 theirs=h36m-1 -o tables"), 0) << ReadFile(folder / "out");
  EXPECT_THAT(ReadFile(folder / "tables/table.md"), AllOf(HasSubstr("| ours | 2 |"), HasSubstr("Protocol h36m-1: ")));
  EXPECT_THAT(ReadFile(folder / "tables/table.csv"), HasSubstr("n_mpjpe_mm_lowest"));
  EXPECT_THAT(ReadFile(folder / "tables/joints.csv"), HasSubstr("RKnee,theirs,"));
  EXPECT_THAT(ReadFile(folder / "tables/actions.md"), HasSubstr("| Walking |"));
  EXPECT_NE(report("ours=h36m-1 theirs=all-frames -o mixed"), 0);
  EXPECT_THAT(ReadFile(folder / "out"), HasSubstr("--mixed"));
  ASSERT_EQ(report("ours=h36m-1 theirs=all-frames -o mixed --mixed"), 0) << ReadFile(folder / "out");
  EXPECT_THAT(ReadFile(folder / "mixed/table.md"), AllOf(HasSubstr("| ours | h36m-1 |"), HasSubstr("| all-frames |")));
}

TEST(EvaluateProgram, ExperimentsReadItsReportAndThatOfInfo) {
  if (std::system("python3 -c pass") != 0) GTEST_SKIP() << "there is no python3";
  const TemporaryFolder folder;
  const std::string data = folder / "data.h5";
  ASSERT_EQ(
      Execute({"simulate", "-o", data, "--subjects", "1", "--clips", "2", "--seconds", "2", "--fps", "10"}).exit_code,
      0);
  const auto python = [&](const std::string& code) {
    WriteFileAtomically(folder / "code.py",
                        fmt::format("import pathlib, sys\nsys.dont_write_bytecode = True\nsys.path.insert(0, '{}')\n"
                                    "import harness\nharness.CANONPOSE = pathlib.Path('{}')\n{}\n",
                                    CANONPOSE_EXPERIMENTS, CANONPOSE_PROGRAM, code));
    const std::string path = folder.path().string();
    return std::system(fmt::format("python3 {0}/code.py >{0}/out 2>&1", path).c_str());
  };
  EXPECT_EQ(python("harness.require_protocol('h36m-1')"), 0) << ReadFile(folder / "out");
  EXPECT_NE(python("harness.require_protocol('h36m')"), 0);
  EXPECT_THAT(ReadFile(folder / "out"), HasSubstr("there are all-frames, h36m-1, h36m-2, 3dhp, skipose"));
  const auto results = [&](const std::string& preset) {
    const std::string call =
        fmt::format("harness.train_and_evaluate(pathlib.Path('{}'), ['{}'], '{}', '{}', 0, {})",
                    (folder / preset).string(), data, data, preset, "['--width', 16, '--epochs', 1]");
    EXPECT_EQ(python("print(" + call + ")"), 0) << ReadFile(folder / "out");
    return ReadFile(folder / "out");
  };
  EXPECT_THAT(results("paper"), AllOf(HasSubstr("'slope_error': 0."), ::testing::Not(HasSubstr("'verdict': None"))));
  EXPECT_THAT(results("supervised"), AllOf(HasSubstr("'decision': 'known from the truth'"), HasSubstr("'slope': None"),
                                           HasSubstr("'verdict': None")));
}

}  // namespace
}  // namespace canonpose
