// Forward pass, losses, gradients and Adam steps against values computed by the method's published implementation.
//
// The project's own small file is always compared with (testdata/golden/make_small.py, which made it, shows its form);
// so is a larger one of the same form: $CANONPOSE_GOLDEN or, without it, the one beside the checkout where there is
// one.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/testing.h"
#include "canonpose/train/adam.h"
#include "canonpose/train/losses.h"

namespace canonpose {
namespace {

using nlohmann::json;

struct Tolerance {
  torch::Dtype dtype;
  double relative;
};

std::uint64_t SplitMix64(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31);
}

/// "2/sqrt(48)" or a plain number.
double ParseScale(const json& scale) {
  if (scale.is_number()) return scale.get<double>();
  const std::string text = scale.get<std::string>();
  const std::size_t root = text.find("/sqrt(");
  if (root == std::string::npos) return std::stod(text);
  return std::stod(text.substr(0, root)) / std::sqrt(std::stod(text.substr(root + 6)));
}

torch::Tensor ToTensor(const json& nested) {
  std::vector<std::int64_t> shape;
  for (const json* level = &nested; level->is_array(); level = &level->front()) {
    shape.push_back(static_cast<std::int64_t>(level->size()));
  }
  std::vector<double> values;
  const std::function<void(const json&)> collect = [&](const json& part) {
    if (!part.is_array()) return values.push_back(part.get<double>());
    for (const json& item : part) collect(item);
  };
  collect(nested);
  return torch::tensor(values, torch::kFloat64).view(shape);
}

void ExpectNear(const torch::Tensor& actual, const torch::Tensor& expected, double relative, const std::string& what) {
  const double scale = expected.abs().max().item<double>();
  const double error = (actual.to(torch::kFloat64) - expected).abs().max().item<double>();
  EXPECT_LE(error, relative * scale) << what << ": largest value " << scale;
}

class GoldenCase {
 public:
  GoldenCase(const std::filesystem::path& path, Tolerance tolerance)
      : golden_(json::parse(std::ifstream(path))), tolerance_(tolerance), lifter_(joints(), width()) {
    lifter_->to(tolerance_.dtype);
    FillParameters();
    batch_.keypoints = ToTensor(golden_["keypoints"]).to(tolerance_.dtype).view({-1, 2, joints()});
    batch_.confidence = ToTensor(golden_["confidences"]).to(tolerance_.dtype);
    MakeFrames();
  }

  void CheckForward() {
    const torch::NoGradGuard no_grad;
    const LifterOutput output = lifter_->forward(LifterInput(batch_));
    ExpectNear(output.pose.flatten(1), ToTensor(golden_["forward"]["pose"]), tolerance_.relative, "pose");
    ExpectNear(output.axis_angle, ToTensor(golden_["forward"]["axis_angle"]), tolerance_.relative, "axis_angle");
    ExpectNear(output.rotation, ToTensor(golden_["forward"]["rotation"]), tolerance_.relative, "rotation");
  }

  void CheckTraining() {
    std::vector<std::pair<std::string, torch::Tensor>> parameters;
    for (const auto& item : lifter_->named_parameters()) parameters.emplace_back(item.key(), item.value());
    Adam adam(parameters, 1e-5);
    int step = 0;
    for (const json& expected : golden_["losses_per_step"]) {
      const Losses losses = Evaluate();
      CheckLoss(losses.reprojection, expected["rep"], step);
      CheckLoss(losses.view, expected["view"], step);
      CheckLoss(losses.camera, expected["camera"], step);
      CheckLoss(losses.total, expected["total"], step);
      losses.total.backward();
      if (step == 0) {
        CheckSummaries(
            golden_["gradients_step0"], [](const torch::Tensor& p) { return p.grad(); }, "gradient of ");
      }
      adam.Step(1e-4);
      ++step;
    }
    CheckSummaries(
        golden_["parameters_after_4_steps"], [](const torch::Tensor& p) { return p.detach(); }, "updated ");
  }

 private:
  [[nodiscard]] int joints() const { return golden_["joints"].get<int>(); }
  [[nodiscard]] int width() const { return golden_["parameters"][0]["shape"][0].get<int>(); }

  void FillParameters() {
    const torch::NoGradGuard no_grad;
    auto parameters = lifter_->named_parameters();
    ASSERT_EQ(parameters.size(), golden_["parameters"].size());
    for (const json& entry : golden_["parameters"]) {
      torch::Tensor& parameter = parameters[entry["name"].get<std::string>()];
      const auto base = entry["stream_base"].get<std::uint64_t>();
      const double scale = ParseScale(entry["scale"]);
      std::vector<float> values(static_cast<std::size_t>(parameter.numel()));
      for (std::size_t k = 0; k < values.size(); ++k) {
        values[k] = static_cast<float>((static_cast<double>(SplitMix64(base + k) >> 40) / 16777216.0 - 0.5) * scale);
      }
      parameter.copy_(torch::tensor(values).view(parameter.sizes()));
    }
  }

  void MakeFrames() {
    const auto views = golden_["views"].get<int>();
    int row = 0;
    for (const json& subject : golden_["subjects"]) {
      TrainingFrame frame{subject.get<int>(), 0, {}};
      for (int v = 0; v < views; ++v) frame.views.push_back({v, row++});
      frames_.push_back(std::move(frame));
    }
  }

  Losses Evaluate() {
    // The golden permutations come by source view, then by subject; ours are asked for by subject, then by source view.
    std::vector<const TrainingFrame*> frames;
    std::set<int> subjects;
    std::map<int, int> counts;
    for (const TrainingFrame& frame : frames_) {
      frames.push_back(&frame);
      ++counts[frame.capture];
    }
    for (const auto& [subject, count] : counts) {
      if (count > 1) subjects.insert(subject);
    }
    const std::size_t views = frames_.front().views.size();
    std::size_t asked = 0;
    const auto draw = [&](std::size_t count) {
      const std::size_t subject = asked / views;
      const std::size_t view = asked % views;
      ++asked;
      auto permutation = golden_["permutations"][view * subjects.size() + subject].get<std::vector<std::size_t>>();
      EXPECT_EQ(permutation.size(), count);
      return permutation;
    };
    const int highest = counts.rbegin()->first;
    const std::vector<std::uint8_t> all_static(static_cast<std::size_t>(highest) + 1, 1);
    const BatchPairs pairs = MakeBatchPairs(frames, all_static, true, draw);
    return ComputeLosses(lifter_->forward(LifterInput(batch_)), batch_, pairs, LossWeights{}, torch::Tensor(), 0);
  }

  void CheckLoss(const torch::Tensor& loss, const json& expected, int step) const {
    EXPECT_NEAR(loss.item<double>(), expected.get<double>(), tolerance_.relative * expected.get<double>())
        << "step " << step;
  }

  template <typename Get>
  void CheckSummaries(const json& expected, Get get, const std::string& what) {
    for (const auto& item : lifter_->named_parameters()) {
      const json& summary = expected[item.key()];
      const torch::Tensor tensor = get(item.value());
      const double norm = summary["l2"].get<double>();
      EXPECT_NEAR(tensor.to(torch::kFloat64).norm().item<double>(), norm, tolerance_.relative * norm)
          << what << item.key();
      const torch::Tensor first = ToTensor(summary["first"]);
      // Single elements are compared on the scale of the tensor's typical element: some are next to nothing.
      const double typical = norm / std::sqrt(static_cast<double>(tensor.numel()));
      const double error =
          (tensor.flatten().narrow(0, 0, first.numel()).to(torch::kFloat64) - first).abs().max().item<double>();
      EXPECT_LE(error, tolerance_.relative * std::max(typical, first.abs().max().item<double>())) << what << item.key();
    }
  }

  json golden_;
  Tolerance tolerance_;
  Lifter lifter_;
  BatchTensors batch_;
  std::vector<TrainingFrame> frames_;
};

void CheckFile(const std::filesystem::path& path) {
  for (const Tolerance tolerance : {Tolerance{torch::kFloat64, 1e-9}, Tolerance{torch::kFloat32, 1e-4}}) {
    SCOPED_TRACE(path.string() + (tolerance.dtype == torch::kFloat64 ? " float64" : " float32"));
    GoldenCase golden(path, tolerance);
    golden.CheckForward();
    golden.CheckTraining();
  }
}

TEST(Golden, OwnCase) { CheckFile(testing::TestData("golden/lifter_losses_small.json")); }

TEST(Golden, PublishedImplementation) {
  const char* given = std::getenv("CANONPOSE_GOLDEN");
  if (given != nullptr) return CheckFile(given);
  CANONPOSE_SKIP_WITHOUT_SHARED("golden/lifter_losses.json");
  CheckFile(testing::Shared("golden/lifter_losses.json"));
}

}  // namespace
}  // namespace canonpose
