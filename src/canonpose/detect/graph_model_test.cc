#include "canonpose/detect/graph_model.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/detect/graph_testing.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::GraphFile;
using ::testing::HasSubstr;

GraphFile SmallModel() {
  GraphFile file;
  file.Weights("head/kernel", {1, 1, 2, 1}, {0.5F, -2.0F});
  file.Node("input", "Placeholder", {});
  file.Node("head/BiasAdd", "_FusedConv2D", {"input", "head/kernel"},
            testing::ConvolutionAttributes(2, true, {testing::kRelu6InBase64}));
  return file;
}

TEST(GraphModel, ReadsOperatorsAndWeights) {
  const testing::TemporaryFolder folder;
  const GraphModel model = ReadGraphModel(SmallModel().Write(folder));
  const GraphNode& node = model.Node("head/BiasAdd");
  EXPECT_EQ(node.op, "_FusedConv2D");
  EXPECT_THAT(node.inputs, ElementsAre("input", "head/kernel"));
  EXPECT_THAT(node.strides, ElementsAre(1, 2, 2, 1));
  EXPECT_THAT(node.fused_ops, ElementsAre("Relu6"));
  EXPECT_EQ(node.padding, "SAME");
  EXPECT_THAT(model.Constant("head/kernel").shape, ElementsAre(1, 1, 2, 1));
  EXPECT_THAT(model.Constant("head/kernel").values, ElementsAre(0.5F, -2.0F));
  EXPECT_EQ(model.NodeLike("head/", "/BiasAdd").name, "head/BiasAdd");
}

TEST(GraphModel, SaysWhatIsNotThere) {
  const testing::TemporaryFolder folder;
  const GraphModel model = ReadGraphModel(SmallModel().Write(folder));
  const auto message = [](auto action) { return testing::ErrorOf(ErrorKind::kBadInput, action); };
  EXPECT_THAT(message([&] { (void)model.Node("x"); }), AllOf(HasSubstr("model.json"), HasSubstr("the operator x")));
  EXPECT_THAT(message([&] { (void)model.Constant("x"); }), HasSubstr("the weights x"));
  EXPECT_THAT(message([&] { (void)model.NodeLike("tail/", "/BiasAdd"); }), HasSubstr("found 0"));
}

TEST(GraphModel, RefusesDamagedFiles) {
  const testing::TemporaryFolder folder;
  const fs::path path = SmallModel().Write(folder);
  const auto message = [&] { return testing::ErrorOf(ErrorKind::kBadInput, [&] { (void)ReadGraphModel(path); }); };

  fs::resize_file(folder / "model.bin", 7);
  EXPECT_THAT(message(), AllOf(HasSubstr("model.bin"), HasSubstr("head/kernel"), HasSubstr("7 bytes")));
  fs::resize_file(folder / "model.bin", 12);
  EXPECT_THAT(message(), AllOf(HasSubstr("model.bin"), HasSubstr("8 bytes"), HasSubstr("12")));
  fs::remove(folder / "model.bin");
  EXPECT_THAT(message(), HasSubstr("model.bin"));

  const auto with = [&](const auto& change) {
    SmallModel().Write(folder);
    nlohmann::json json = SmallModel().ToJson();
    change(json);
    std::ofstream(path) << json.dump();
    return message();
  };
  EXPECT_THAT(with([](auto& json) { json.erase("modelTopology"); }), HasSubstr("modelTopology"));
  EXPECT_THAT(with([](auto& json) { json["weightsManifest"] = nlohmann::json::array(); }),
              HasSubstr("one file of weights"));
  EXPECT_THAT(with([](auto& json) { json["weightsManifest"][0]["weights"][0]["dtype"] = "complex64"; }),
              HasSubstr("float16, float32 or int32"));
  EXPECT_THAT(with([](auto& json) {
                json["weightsManifest"][0]["weights"][0]["shape"] = {99999, 99999, 99999};
              }),
              HasSubstr("the shape of a weight"));
  EXPECT_THAT(with([](auto& json) { json["modelTopology"]["node"][2]["attr"]["padding"]["s"] = "#"; }),
              HasSubstr("base64"));
  EXPECT_THAT(with([](auto& json) { json["modelTopology"]["node"][2]["attr"]["strides"]["list"]["i"][1] = "two"; }),
              HasSubstr("an integer"));
  for (const nlohmann::json& stride : {nlohmann::json("4294967297"), nlohmann::json(4294967297), nlohmann::json("1-1"),
                                       nlohmann::json("-"), nlohmann::json("")}) {
    EXPECT_THAT(with([&](auto& json) { json["modelTopology"]["node"][2]["attr"]["strides"]["list"]["i"][1] = stride; }),
                HasSubstr("an integer of 32 bits"))
        << stride;
  }
  std::ofstream(path) << SmallModel().ToJson().dump().substr(0, 100);
  EXPECT_THAT(message(), HasSubstr("model.json"));
}

TEST(HalfToFloat, KnowsAllKindsOfNumbers) {
  EXPECT_EQ(HalfToFloat(0x0000), 0.0F);
  EXPECT_EQ(HalfToFloat(0x3C00), 1.0F);
  EXPECT_EQ(HalfToFloat(0xC000), -2.0F);
  EXPECT_EQ(HalfToFloat(0x3555), 0.333251953125F);
  EXPECT_EQ(HalfToFloat(0x7BFF), 65504.0F);
  EXPECT_EQ(HalfToFloat(0x0001), 0x1p-24F);
  EXPECT_EQ(HalfToFloat(0x83FF), -1023 * 0x1p-24F);
  EXPECT_TRUE(std::isinf(HalfToFloat(0x7C00)));
  EXPECT_TRUE(std::isnan(HalfToFloat(0x7E00)));
}

}  // namespace
}  // namespace canonpose
