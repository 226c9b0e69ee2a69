#include "canonpose/detect/conv_network.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <torch/torch.h>

#include "canonpose/base/error.h"

namespace canonpose {
namespace internal {

enum class Operation { kPointwise, kConvolution, kDepthwise, kAdd, kDouble };
enum class Activation { kNone, kRelu, kRelu6 };

/// One operator with its weights. All values are (1, channels, height, width) with the channels next to each other in
/// memory, so that a 1x1 convolution is one product of matrices.
struct Step {
  std::string name;
  Operation operation = Operation::kAdd;
  Activation activation = Activation::kNone;
  std::vector<int> inputs;    ///< places of values
  int output = 0;             ///< place of its value
  std::vector<int> released;  ///< places whose values nobody needs any more
  torch::Tensor weight;       ///< kPointwise: (in, out); others: (out, in / groups, height, width)
  torch::Tensor bias;         ///< (out)
  int stride = 1;
  bool is_same_padded = false;
};

/// Memory for values, used again and again: fresh memory costs as much time as the products.
class Buffers {
 public:
  torch::Tensor Take(const std::vector<std::int64_t>& shape) {
    std::int64_t count = 1;
    for (const std::int64_t extent : shape) count *= extent;
    auto best = free_.end();
    for (auto buffer = free_.begin(); buffer != free_.end(); ++buffer) {
      if (buffer->numel() >= count && (best == free_.end() || buffer->numel() < best->numel())) best = buffer;
    }
    torch::Tensor taken = best == free_.end() ? torch::empty({count}) : *best;
    if (best != free_.end()) free_.erase(best);
    taken_.push_back(taken);
    return taken.narrow(0, 0, count).view(shape);
  }

  /// Gives back the memory of a value that came from Take(); others are not noticed.
  void GiveBack(const torch::Tensor& value) {
    const auto found = std::ranges::find_if(
        taken_, [&](const torch::Tensor& buffer) { return buffer.data_ptr() == value.data_ptr(); });
    if (found == taken_.end()) return;
    free_.push_back(*found);
    taken_.erase(found);
  }

 private:
  std::vector<torch::Tensor> free_;
  std::vector<torch::Tensor> taken_;
};

}  // namespace internal

namespace {

using internal::Activation;
using internal::Buffers;
using internal::Operation;
using internal::Step;

/// MoveNet has about 200; each takes its share of the stack.
constexpr int kLongestChain = 1000;
/// Inputs' sides are multiples of it.
constexpr int kSmallest = 32;

torch::Tensor ToTensor(const GraphConstant& constant) {
  std::vector<std::int64_t> shape(constant.shape.begin(), constant.shape.end());
  return torch::from_blob(const_cast<float*>(constant.values.data()), shape, torch::kFloat32).clone();
}

/// The margins that TensorFlow adds so that the output has ceil(size / stride) elements: the odd one at the end.
std::pair<std::int64_t, std::int64_t> SameMargins(std::int64_t size, std::int64_t kernel, std::int64_t stride) {
  const std::int64_t out = (size + stride - 1) / stride;
  const std::int64_t all = std::max<std::int64_t>(0, (out - 1) * stride + kernel - size);
  return {all / 2, all - all / 2};
}

void Activate(torch::Tensor& value, Activation activation) {
  if (activation == Activation::kRelu) value.clamp_min_(0.0);
  if (activation == Activation::kRelu6) value.clamp_(0.0, 6.0);
}

torch::Tensor Pointwise(const Step& step, const torch::Tensor& input, Buffers& buffers) {
  const std::int64_t height = input.size(2);
  const std::int64_t width = input.size(3);
  const torch::Tensor rows = input.permute({0, 2, 3, 1}).reshape({height * width, input.size(1)});
  torch::Tensor output = buffers.Take({height * width, step.weight.size(1)});
  torch::addmm_out(output, step.bias, rows, step.weight);
  return output.view({1, height, width, step.weight.size(1)}).permute({0, 3, 1, 2});
}

torch::Tensor Convolve(const Step& step, const torch::Tensor& input) {
  const std::int64_t groups = step.operation == Operation::kDepthwise ? input.size(1) : 1;
  std::vector<std::int64_t> margin{0, 0};
  torch::Tensor weight = step.weight;
  if (step.is_same_padded) {
    const auto [top, bottom] = SameMargins(input.size(2), weight.size(2), step.stride);
    const auto [left, right] = SameMargins(input.size(3), weight.size(3), step.stride);
    // The library's margins are the same on both sides: zeros before the kernel make up for the missing ones.
    if (top != bottom || left != right) weight = torch::constant_pad_nd(weight, {right - left, 0, bottom - top, 0});
    margin = {bottom, right};
  }
  const std::vector<std::int64_t> stride{step.stride, step.stride};
  return torch::mkldnn_convolution(input, weight, step.bias, margin, stride, {1, 1}, groups);
}

torch::Tensor Double(const torch::Tensor& input) {
  return torch::upsample_bilinear2d(input, {2 * input.size(2), 2 * input.size(3)}, /*align_corners=*/false);
}

torch::Tensor Apply(const Step& step, const std::vector<torch::Tensor>& values, Buffers& buffers) {
  const torch::Tensor& input = values[static_cast<std::size_t>(step.inputs.front())];
  torch::Tensor output;
  switch (step.operation) {
    case Operation::kPointwise:
      output = Pointwise(step, input, buffers);
      break;
    case Operation::kConvolution:
    case Operation::kDepthwise:
      output = Convolve(step, input);
      break;
    case Operation::kAdd:
      output = input + values[static_cast<std::size_t>(step.inputs.back())];
      break;
    case Operation::kDouble:
      output = Double(input);
      break;
  }
  Activate(output, step.activation);
  return output;
}

FeatureMap ToFeatureMap(const torch::Tensor& value) {
  const torch::Tensor rows = value.permute({0, 2, 3, 1}).contiguous();
  FeatureMap map;
  map.height = static_cast<int>(rows.size(1));
  map.width = static_cast<int>(rows.size(2));
  map.channels = static_cast<int>(rows.size(3));
  map.values.assign(rows.data_ptr<float>(), rows.data_ptr<float>() + rows.numel());
  return map;
}

}  // namespace

struct ConvNetwork::Plan {
  std::vector<internal::Step> steps;
  std::vector<int> outputs;  ///< places of values
  int places = 1;            ///< of which the first is the input's
  std::vector<std::array<int, 3>> shapes;
  internal::Buffers buffers;
};

namespace {

/// Orders the operators that outputs need, and takes their weights.
class Planner {
 public:
  Planner(const GraphModel& model, const std::string& input) : model_(model) { places_[input] = 0; }

  /// The place of a node's value.
  int Place(const std::string& name) {
    const auto found = places_.find(name);
    if (found != places_.end()) return found->second;
    if (!open_.insert(name).second) Fail(name, "no operator that needs its own output");
    if (++depth_ > kLongestChain) Fail(name, fmt::format("no more than {} operators in a row", kLongestChain));
    Step step = MakeStep(model_.Node(name));
    --depth_;
    step.output = places_[name] = next_place_++;
    steps_.push_back(std::move(step));
    return steps_.back().output;
  }

  std::vector<Step> TakeSteps(const std::vector<int>& outputs) {
    std::set<int> needed(outputs.begin(), outputs.end());
    for (auto step = steps_.rbegin(); step != steps_.rend(); ++step) {
      for (const int input : step->inputs) {
        if (needed.insert(input).second) step->released.push_back(input);
      }
    }
    return std::move(steps_);
  }

  [[nodiscard]] int place_count() const { return next_place_; }

 private:
  [[noreturn]] void Fail(const std::string& node, const std::string& expected) const {
    const auto found = model_.nodes.find(node);
    ThrowBadInput(
        {model_.file, node, expected, found == model_.nodes.end() ? "nothing" : found->second.op, kGetDetectorAgain});
  }

  void RequireInputs(const GraphNode& node, std::size_t least) const {
    if (node.inputs.size() < least) Fail(node.name, fmt::format("an operator with {} inputs", least));
  }

  Step MakeStep(const GraphNode& node) {
    Step step;
    step.name = node.name;
    if (node.op == "_FusedConv2D" || node.op == "FusedDepthwiseConv2dNative" || node.op == "DepthwiseConv2dNative" ||
        node.op == "Conv2D") {
      TakeConvolution(node, step);
      step.inputs = {Place(node.inputs[0])};
    } else if (node.op == "AddV2") {
      RequireInputs(node, 2);
      step.inputs = {Place(node.inputs[0]), Place(node.inputs[1])};
    } else if (node.op == "ResizeBilinear") {
      RequireInputs(node, 1);
      if (!node.half_pixel_centers) Fail(node.name, "resizing with half_pixel_centers");
      step.operation = Operation::kDouble;
      step.inputs = {Place(node.inputs[0])};
    } else {
      Fail(node.name, "a convolution, an addition or a bilinear resizing");
    }
    return step;
  }

  void TakeConvolution(const GraphNode& node, Step& step) const {
    RequireInputs(node, 2);
    const GraphConstant& kernel = model_.Constant(node.inputs[1]);
    const bool is_depthwise = node.op.find("Depthwise") != std::string::npos;
    if (kernel.shape.size() != 4 || kernel.values.empty() || (is_depthwise && kernel.shape[3] != 1))
      Fail(node.name, "a kernel of four dimensions");
    if (node.strides.size() != 4 || node.strides[1] != node.strides[2] || node.strides[1] < 1) {
      Fail(node.name, "equal strides in height and width");
    }
    if (node.padding != "SAME" && node.padding != "VALID") Fail(node.name, "padding SAME or VALID");
    step.stride = node.strides[1];
    step.is_same_padded = node.padding == "SAME";
    const bool is_pointwise = !is_depthwise && kernel.shape[0] == 1 && kernel.shape[1] == 1 && step.stride == 1;
    step.operation = is_pointwise   ? Operation::kPointwise
                     : is_depthwise ? Operation::kDepthwise
                                    : Operation::kConvolution;
    const torch::Tensor weight = ToTensor(kernel);
    const std::int64_t outputs = kernel.shape[is_depthwise ? 2 : 3];
    step.weight = is_pointwise   ? weight.view({kernel.shape[2], outputs}).contiguous()
                  : is_depthwise ? weight.permute({2, 3, 0, 1}).contiguous()
                                 : weight.permute({3, 2, 0, 1}).contiguous();
    step.bias = torch::zeros({outputs});
    for (const std::string& fused : node.fused_ops) TakeFused(node, fused, step);
  }

  void TakeFused(const GraphNode& node, const std::string& fused, Step& step) const {
    if (fused == "BiasAdd") {
      RequireInputs(node, 3);
      const GraphConstant& bias = model_.Constant(node.inputs[2]);
      if (static_cast<std::int64_t>(bias.values.size()) != step.bias.numel()) {
        Fail(node.name, fmt::format("a bias of {} values", step.bias.numel()));
      }
      step.bias = ToTensor(bias).view({step.bias.numel()});
    } else if (fused == "Relu6") {
      step.activation = Activation::kRelu6;
    } else if (fused == "Relu") {
      step.activation = Activation::kRelu;
    } else {
      Fail(node.name, "BiasAdd, Relu or Relu6, not " + fused);
    }
  }

  const GraphModel& model_;
  std::map<std::string, int> places_;
  std::set<std::string> open_;
  std::vector<Step> steps_;
  int next_place_ = 1;
  int depth_ = 0;  ///< operators that wait for their inputs
};

}  // namespace

ConvNetwork::ConvNetwork(const GraphModel& model, const std::string& input, const std::vector<std::string>& outputs)
    : plan_(std::make_unique<Plan>()) {
  at::init_num_threads();  // the process's number of threads holds for this thread only once it was told
  try {
    Planner planner(model, input);
    for (const std::string& output : outputs) plan_->outputs.push_back(planner.Place(output));
    plan_->steps = planner.TakeSteps(plan_->outputs);
    plan_->places = planner.place_count();
    // Weights of wrong shapes show as soon as they are used.
    for (const FeatureMap& map : Evaluate(std::vector<float>(3 * kSmallest * kSmallest, 0.0F), kSmallest, kSmallest)) {
      plan_->shapes.push_back({map.height, map.width, map.channels});
    }
  } catch (const c10::Error& error) {
    const std::string what = error.what_without_backtrace();
    ThrowBadInput({model.file, "weightsManifest", "weights that fit the operators", what.substr(0, what.find('\n')),
                   kGetDetectorAgain});
  }
}

ConvNetwork::~ConvNetwork() = default;
ConvNetwork::ConvNetwork(ConvNetwork&&) noexcept = default;
ConvNetwork& ConvNetwork::operator=(ConvNetwork&&) noexcept = default;

const std::vector<std::array<int, 3>>& ConvNetwork::output_shapes() const { return plan_->shapes; }

int ConvNetwork::operator_count() const { return static_cast<int>(plan_->steps.size()); }

std::vector<FeatureMap> ConvNetwork::Evaluate(std::span<const float> input, int height, int width) const {
  CANONPOSE_CHECK(std::ssize(input) == 3L * height * width, "{} values for {}x{}", input.size(), width, height);
  const c10::InferenceMode inference;
  std::vector<torch::Tensor> values(static_cast<std::size_t>(plan_->places));
  values[0] =
      torch::from_blob(const_cast<float*>(input.data()), {1, height, width, 3}, torch::kFloat32).permute({0, 3, 1, 2});
  for (const Step& step : plan_->steps) {
    values[static_cast<std::size_t>(step.output)] = Apply(step, values, plan_->buffers);
    for (const int place : step.released) {
      torch::Tensor& value = values[static_cast<std::size_t>(place)];
      plan_->buffers.GiveBack(value);
      value = torch::Tensor();
    }
  }
  std::vector<FeatureMap> outputs;
  for (const int place : plan_->outputs) {
    const torch::Tensor& value = values[static_cast<std::size_t>(place)];
    outputs.push_back(ToFeatureMap(value));
    plan_->buffers.GiveBack(value);
  }
  return outputs;
}

}  // namespace canonpose
