#include "canonpose/model/model_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/model/tensors.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

ModelFile Example() {
  ModelFile model;
  model.info.program_version = "1.2.3";
  model.info.skeleton = *FindSkeleton("h36m-17");
  model.info.source = {"openpose", "body_25b", 1.5, {"a", "b"}, "the morphing network 12"};
  model.info.width = 16;
  model.info.preset = "plus";
  model.info.options = R"({"width": 16})";
  model.info.seed = 7;
  model.info.steps = 1234;
  model.info.mirror = {"flipped", 0.15, 0.01};
  model.info.trap = {"suspicious", 1.3, 95.0, 20.0};
  model.info.perspective = 0.8;
  model.info.data_files = {"data.h5"};
  model.info.data_fingerprints = {"0123456789abcdef"};
  Lifter lifter(17, 16);
  lifter->Initialise(1);
  model.parameters = ParametersOf(*lifter);
  return model;
}

TEST(ModelFile, RoundTripKeepsEverything) {
  const TemporaryFolder folder;
  const ModelFile model = Example();
  WriteModelFile(folder / "model.cpm", model);
  EXPECT_TRUE(IsModel(folder / "model.cpm"));
  EXPECT_TRUE(IsModel(folder.path()));
  const ModelFile read = ReadModelFile(folder.path());
  EXPECT_EQ(read.info.program_version, "1.2.3");
  EXPECT_TRUE(read.info.skeleton.SameJoints(model.info.skeleton));
  EXPECT_EQ(read.info.source.mapping, model.info.source.mapping);
  EXPECT_EQ(read.info.source.confidence_scale, 1.5);
  EXPECT_EQ(read.info.source.morph, "the morphing network 12");
  EXPECT_EQ(read.info.options, model.info.options);
  EXPECT_EQ(read.info.steps, 1234);
  EXPECT_EQ(read.info.mirror.decision, "flipped");
  EXPECT_EQ(read.info.mirror.slope, 0.15);
  EXPECT_EQ(read.info.trap.verdict, "suspicious");
  EXPECT_EQ(read.info.trap.depth_ratio, 1.3);
  EXPECT_EQ(read.info.trap.angle_deg, 95.0);
  EXPECT_EQ(read.info.trap.scatter_deg, 20.0);
  EXPECT_EQ(read.info.perspective, 0.8);
  EXPECT_EQ(read.info.data_fingerprints, model.info.data_fingerprints);
  ASSERT_EQ(read.parameters.size(), model.parameters.size());
  for (const auto& [name, array] : model.parameters) EXPECT_EQ(read.parameters.at(name).values, array.values) << name;
}

TEST(ModelFile, RotationAndInputFormAreKeptAndOlderFilesHaveNone) {
  const TemporaryFolder folder;
  ModelFile model = Example();
  WriteModelFile(folder / "plain.cpm", model);
  const ModelInfo plain = ReadModelInfo(folder / "plain.cpm");
  EXPECT_EQ(plain.rotation, RotationForm::kAxisAngle);
  EXPECT_EQ(plain.input.ray, RayForm::kOff);
  model.info.rotation = RotationForm::kSix;
  model.info.input = {RayForm::kRoot, FocalSource::kKnown};
  Lifter lifter(17, 16, RotationForm::kSix);
  lifter->Initialise(1);
  model.parameters = ParametersOf(*lifter);
  WriteModelFile(folder / "turned.cpm", model);
  const ModelFile read = ReadModelFile(folder / "turned.cpm");
  EXPECT_EQ(read.info.rotation, RotationForm::kSix);
  EXPECT_EQ(read.info.input.ray, RayForm::kRoot);
  EXPECT_EQ(read.info.input.focal, FocalSource::kKnown);
  EXPECT_EQ(MakeLifter(read, "turned.cpm", torch::kCPU)->named_parameters()["enc_rot.bias"].size(0), 6);
  // A program that only knows version 1 must not mistake one for the other.
  h5::File plain_file = h5::File::OpenForReading(folder / "plain.cpm");
  h5::File turned_file = h5::File::OpenForReading(folder / "turned.cpm");
  EXPECT_EQ(plain_file.root().GetInt("version"), 1);
  EXPECT_FALSE(plain_file.root().HasAttribute("ray"));
  EXPECT_EQ(turned_file.root().GetInt("version"), 2);
  h5::File odd = h5::File::CreateAt(folder / "odd.cpm");
  odd.root().SetString("format", "canonpose-model");
  odd.root().SetInt("version", 2);
  odd.root().SetString("program_version", "1.2.3");
  odd.root().SetInt("width", 16);
  odd.root().SetString("ray", "sideways");
  odd.Commit();
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadModelFile(folder / "odd.cpm"); }),
              AllOf(HasSubstr("attribute ray"), HasSubstr("off, root"), HasSubstr("sideways")));
}

TEST(ModelFile, OfBeforeTrapsWereLookedForIsReadable) {
  const TemporaryFolder folder;
  ModelFile model = Example();
  model.info.trap = {};
  WriteModelFile(folder / "model.cpm", model);
  EXPECT_EQ(h5::File::OpenForReading(folder / "model.cpm").root().HasAttribute("trap_verdict"), false);
  EXPECT_EQ(ReadModelFile(folder / "model.cpm").info.trap.verdict, "");
}

TEST(ModelFile, DoubtsAreOfTrapAndMirror) {
  ModelInfo info;
  info.mirror.decision = "kept";
  info.trap.verdict = "suspicious";
  EXPECT_TRUE(DoubtsAbout(info).empty());
  info.mirror.decision = "undecided";
  EXPECT_THAT(DoubtsAbout(info), ::testing::ElementsAre(HasSubstr("which way round depth is")));
  info.trap = {"trapped", 1.93, 34.0, 34.0};
  EXPECT_THAT(DoubtsAbout(info), ::testing::ElementsAre(HasSubstr("1.93 times as deep"), HasSubstr("depth is")));
}

TEST(ModelFile, SameModelSameBits) {
  const TemporaryFolder folder;
  WriteModelFile(folder / "a.cpm", Example());
  WriteModelFile(folder / "b.cpm", Example());
  EXPECT_EQ(ReadFile(folder / "a.cpm"), ReadFile(folder / "b.cpm"));
}

TEST(ModelFile, LifterGivesTheSamePosesAfterReading) {
  const TemporaryFolder folder;
  WriteModelFile(folder / "model.cpm", Example());
  const ModelFile model = ReadModelFile(folder / "model.cpm");
  Lifter original(17, 16);
  original->Initialise(1);
  const auto read = MakeLifter(model, "model.cpm", torch::kCPU);
  const torch::NoGradGuard no_grad;
  const torch::Tensor input = torch::ones({1, 51});
  EXPECT_TRUE(torch::equal(original->forward(input).pose, read->forward(input).pose));
}

TEST(ModelFile, RefusesOtherVersionsFormatsAndTruncations) {
  const TemporaryFolder folder;
  WriteModelFile(folder / "model.cpm", Example());
  const std::string whole = ReadFile(folder / "model.cpm");
  for (std::size_t size = 0; size < whole.size(); size += whole.size() / 17) {
    WriteFileAtomically(folder / "cut.cpm", whole.substr(0, size));
    EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadModelFile(folder / "cut.cpm"); }), HasSubstr("cut.cpm"));
  }
  {
    h5::File file = h5::File::CreateAt(folder / "other.cpm");
    file.root().SetString("format", "canonpose-model");
    file.root().SetInt("version", 9);
    file.Commit();
  }
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadModelFile(folder / "other.cpm"); }),
              AllOf(HasSubstr("version"), HasSubstr("expected 1 to 3"), HasSubstr("found 9")));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadModelFile(folder / "nothing.cpm"); }), HasSubstr("nothing.cpm"));
}

TEST(ModelFile, RefusesMorphingNetworksOfMorphingNetworks) {
  const TemporaryFolder folder;
  ModelFile model = Example();
  for (int depth = 0; depth < 2; ++depth) {
    ModelFile outer = Example();
    outer.info.morph = std::make_shared<const ModelFile>(model);
    model = outer;
  }
  // As where a damaged group holds itself, and reading it would have no end.
  WriteModelFile(folder / "model.cpm", model);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadModelFile(folder / "model.cpm"); }),
              HasSubstr("/morph/morph: expected no morphing network of a morphing network"));
  WriteModelFile(folder / "model.cpm", *model.info.morph);
  EXPECT_NE(ReadModelFile(folder / "model.cpm").info.morph, nullptr);
}

TEST(ModelFile, RefusesWeightsOfAnotherWidth) {
  ModelFile model = Example();
  model.info.width = 32;
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { MakeLifter(model, "model.cpm", torch::kCPU); }),
              AllOf(HasSubstr("upscale.weight"), HasSubstr("(32, 51)"), HasSubstr("(16, 51)")));
}

}  // namespace
}  // namespace canonpose
