#include "canonpose/train/options.h"

#include <algorithm>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/names.h"
#include "canonpose/train/option_table.h"

namespace canonpose {
namespace {

constexpr std::tuple kTrainTable{
    Text("preset", &TrainOptions::preset, "the name of a preset", "Where the options came from, for the record"),
    Number("epochs", &TrainOptions::epochs, Range::AtLeast(0),
           "Passes through the data. 0: `default_epochs`, or more until `min_steps` steps are taken"),
    Number("default_epochs", &TrainOptions::default_epochs, Range::AtLeast(1),
           "Passes through the data where `epochs` is 0"),
    Number("min_steps", &TrainOptions::min_steps, Range::AtLeast(0),
           "A small recording is passed through more often until this many steps are taken"),
    Choice("network", &TrainOptions::network, "The lifter's layers"),
    Number("width", &TrainOptions::width, Range::Between(1, 65536), "Width of the network's layers"),
    Number("batch_frames", &TrainOptions::batch_frames, Range::AtLeast(1), "Frames per step, each with all its views"),
    Number("learning_rate", &TrainOptions::learning_rate, Range::MoreThan(0), "Learning rate at the start"),
    Number("weight_decay", &TrainOptions::weight_decay, Range::AtLeast(0), "L2 penalty, added to the gradient"),
    Choice("schedule", &TrainOptions::schedule, "How the learning rate falls"),
    Choice("supervision", &TrainOptions::supervision, "What is learned from"),
    Choice("bootstrap", &TrainOptions::bootstrap,
           "With `supervision=solved`, for data that are not solved yet: what solving starts from"),
    Choice("input_confidences", &TrainOptions::input_confidences,
           "What the network sees of the detector's confidences"),
    Choice(
        "loss_confidences", &TrainOptions::loss_confidences,
        "Whether joints count by their confidence in the losses, as published. off: all visible joints count the same"),
    Choice("consistency", &TrainOptions::consistency, "How views, and frames of static cameras, are made to agree"),
    Choice("ray", &TrainOptions::ray, "How the pose is presented to the network"),
    Choice("focal", &TrainOptions::focal, "With `ray=root`: where the camera's intrinsics come from"),
    Choice("rotation", &TrainOptions::rotation, "Form of the network's rotations"),
    Number("new_views", &TrainOptions::new_views, Range::Between(0, 1),
           "Share of poses that are seen from a new, simulated camera; needs `supervision`"),
    Number("flips", &TrainOptions::flips, Range::Between(0, 1),
           "Probability that left and right of a pose are exchanged; needs `supervision`"),
    Number("joint_dropout", &TrainOptions::joint_dropout, Range::Between(0, 1),
           "Probability that one to four joints of a pose are hidden; needs `supervision`"),
    Choice("uncertainty_weights", &TrainOptions::uncertainty_weights,
           "With `supervision=solved`: whether a joint of uncertainty s, relative to the size of its pose, counts "
           "1 / (1 + (s / median s)^2)"),
    Number("view_weight", &TrainOptions::view_weight, Range::AtLeast(0), "Weight of view consistency"),
    Number("camera_weight", &TrainOptions::camera_weight, Range::AtLeast(0), "Weight of camera consistency"),
    Choice("camera_consistency", &TrainOptions::camera_consistency,
           "Which frames share the relative rotations of their cameras"),
    Number("camera_window_seconds", &TrainOptions::camera_window_seconds, Range::MoreThan(0),
           "With `camera_consistency=window`: length of the window at the start, seconds"),
    Number("camera_window_end", &TrainOptions::camera_window_end, {0.0, 1.0, /*excludes_min=*/true},
           "With `camera_consistency=window`: share of the steps after which the window's length and weight are zero"),
    Number("rotation_spread", &TrainOptions::rotation_spread, Range::MoreThan(0),
           "Factor of the rotation layer's initial weights"),
    Number("restarts", &TrainOptions::restarts, Range::Between(1, 1000),
           "Short runs from different seeds; training continues from the best of them"),
    Number("restart_steps", &TrainOptions::restart_steps, Range::AtLeast(1),
           "Length of a short run. After 500 steps a run that will end in the trap still has the smaller loss "
           "(docs/results.md)"),
    Choice("perspective", &TrainOptions::perspective, "The projection in the losses"),
    Number("perspective_warmup", &TrainOptions::perspective_warmup, Range::Between(0, 1),
           "Share of the steps before k is learned; it is 0 until then"),
    Number("perspective_learning_rate", &TrainOptions::perspective_learning_rate, Range::MoreThan(0),
           "Learning rate of k"),
    Choice("mirror", &TrainOptions::mirror, "Which of the two mirror images to keep"),
    Number("validation", &TrainOptions::validation, Range::Between(0, 0.5),
           "Share of the frames that is held out, at the end of every 50"),
    Number("seed", &TrainOptions::seed, Range::AtLeast(0), "Seed of all randomness"),
    NotInResults(Number("threads", &TrainOptions::threads, Range::AtLeast(0),
                        "Threads; more than one helps wide networks on an idle machine. 0: one to train, all cores to "
                        "solve")),
    NotInResults(Text("device", &TrainOptions::device, "cpu, cuda", "Where networks are computed")),
    NotInResults(Number("checkpoint_seconds", &TrainOptions::checkpoint_seconds, Range::AtLeast(0),
                        "Time between checkpoints, seconds"))};
static_assert(CoversAllFields<TrainOptions>(kTrainTable));

void ValidateViews(const TrainOptions& options) {
  if (options.network != LifterKind::kCanonical) {
    ThrowInvalidArgument("`network={}` outputs no rotation that views could share: it needs `supervision`",
                         ToString(options.network));
  }
  if (options.consistency == Consistency::kEqualCameras && options.camera_consistency == CameraConsistency::kOff) {
    ThrowInvalidArgument("`consistency=equal_cameras` is a form of camera consistency: set `camera_consistency` too");
  }
  if (options.new_views > 0 || options.flips > 0 || options.joint_dropout > 0) {
    ThrowInvalidArgument(
        "`new_views`, `flips` and `joint_dropout` change the 3D pose to learn from: they need `supervision`");
  }
  if (options.ray != RayForm::kOff && options.camera_consistency != CameraConsistency::kOff) {
    ThrowInvalidArgument(
        "`ray={}` rotates the camera with every pose, so that none is static: `camera_consistency` must be off",
        ToString(options.ray));
  }
}

void ValidateSupervised(const TrainOptions& options) {
  const char* supervision = ToString(options.supervision);
  if (options.restarts > 1) {
    ThrowInvalidArgument(
        "`restarts` are compared by their loss of view consistency, which `supervision={}` does not compute: leave "
        "`restarts` at 1",
        supervision);
  }
  if (options.consistency != Consistency::kMixing || !options.loss_confidences) {
    ThrowInvalidArgument(
        "`consistency` and `loss_confidences` are about the losses between views, which `supervision={}` does not "
        "compute: leave them out",
        supervision);
  }
  if (options.network == LifterKind::kMartinez &&
      (options.rotation != RotationForm::kAxisAngle || options.rotation_spread != 1.0)) {
    ThrowInvalidArgument("`network=martinez` outputs no rotation: leave `rotation` and `rotation_spread` out");
  }
  if (options.mirror != MirrorHandling::kAuto) {
    ThrowInvalidArgument(
        "with `supervision={}` a lifter has no mirror to choose, it learns the poses as they are: leave `mirror` out{}",
        supervision,
        options.supervision == Supervision::kSolved
            ? "; if the solved poses are mirrored, run `canonpose solve` with `mirror=flip` and train on the result"
            : "");
  }
  if (options.perspective != PerspectiveForm::kOff || options.camera_consistency != CameraConsistency::kOff) {
    ThrowInvalidArgument(
        "`supervision={}` compares poses in 3D, without a projection: `perspective` and `camera_consistency` must be "
        "off",
        supervision);
  }
}

}  // namespace

void TrainOptions::Validate() const {
  RequireRanges(kTrainTable, *this);
  if (is_supervised()) {
    ValidateSupervised(*this);
  } else {
    ValidateViews(*this);
  }
}

std::string TrainOptions::ToJson(bool only_what_changes_results) const {
  return WriteJson(kTrainTable, *this, only_what_changes_results);
}

TrainOptions TrainOptions::FromJson(const std::string& text, const std::string& file) {
  const auto damaged = [&](const std::string& what) {
    ThrowBadInput(
        {file, "attribute options", "the options of training as JSON", what, "restore the file or train again"});
  };
  TrainOptions options;
  try {
    options = ReadJson<TrainOptions>(kTrainTable, text);
  } catch (const nlohmann::json::exception&) {
    damaged("damaged text");
  } catch (const Error& error) {
    damaged(error.what());
  }
  return options;
}

bool TrainOptions::Has(const std::string& name) { return HasRow(kTrainTable, name); }

void TrainOptions::Set(const std::string& name, const std::string& value) {
  if (name == "preset") {
    ThrowInvalidArgument(
        "`preset` stands for a choice of all options and is not set like one of them: give `preset={}`", value);
  }
  SetField(kTrainTable, name, value, *this);
  if (name == "epochs" && epochs == 0) {
    ThrowInvalidArgument("`epochs`: expected 1 or more, found {}; without it, the size of the recording decides",
                         value);
  }
}

std::string TrainOptions::Get(const std::string& name) const { return GetField(kTrainTable, name, *this); }

std::vector<std::string> TrainOptions::Differences(const TrainOptions& other) const {
  std::vector<std::string> names;
  ForEachRow(kTrainTable, [&](const auto& row) {
    if (row.changes_results && Get(row.name) != other.Get(row.name)) names.emplace_back(row.name);
  });
  return names;
}

const std::vector<Preset>& Presets() {
  static const std::vector<Preset> presets = {
      {"paper", "the method as published, without camera consistency; the mirror is decided once, at the end", {}},
      {"paper+c", "paper with camera consistency", {{"camera_consistency", "static"}}},
      {"plus",
       "paper+c with a learned perspective factor, a quarter of the width and a higher learning rate",
       // A quarter of the width costs little accuracy (docs/results.md) and makes small recordings a matter of a
       // minute.
       {{"camera_consistency", "static"}, {"perspective", "learned"}, {"width", "256"}, {"learning_rate", "0.001"}}},
      {"supervised",
       "the same lifter trained on the dataset's true 3D poses: what the others are measured against",
       {{"supervision", "truth"}}},
      {"martinez",
       "the network of Martinez et al. (ICCV 2017), trained on the dataset's true 3D poses",
       {{"supervision", "truth"}, {"network", "martinez"}, {"learning_rate", "0.001"}, {"weight_decay", "0"}}},
      {"epipolar",
       "the same lifter trained on 3D poses triangulated with the dataset's calibration",
       {{"supervision", "triangulated"}}},
      {"best",
       "a lifter trained on the 3D poses that `canonpose solve` finds from all views, seen from many more views",
       // Without uncertainty_weights: uncertain joints are the hard ones, and weighing them less costs more than their
       // errors (docs/results.md).
       {{"supervision", "solved"},
        {"width", "256"},
        {"learning_rate", "0.001"},
        {"schedule", "cosine"},
        {"ray", "root"},
        {"input_confidences", "missing"},
        {"new_views", "0.8"},
        {"flips", "0.5"},
        {"joint_dropout", "0.15"}}}};
  return presets;
}

TrainOptions PresetOptions(const std::string& name) {
  const auto preset = std::ranges::find(Presets(), name, &Preset::name);
  if (preset == Presets().end()) {
    ThrowInvalidArgument("`preset`: expected one of {}, found \"{}\"", PresetNames(), name);
  }
  TrainOptions options;
  options.preset = name;
  for (const auto& [field, value] : preset->differences) options.Set(field, value);
  return options;
}

std::string PresetNames() {
  std::vector<std::string> names;
  for (const Preset& preset : Presets()) names.emplace_back(preset.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

namespace {

/// "; 256 for plus and best", or nothing where all presets have the default.
std::string OtherDefaults(const std::string& field) {
  std::vector<std::pair<std::string, std::vector<std::string>>> presets_by_value;
  for (const Preset& preset : Presets()) {
    for (const auto& [name, value] : preset.differences) {
      if (name != field) continue;
      auto found = std::ranges::find(presets_by_value, value, [](const auto& entry) { return entry.first; });
      if (found == presets_by_value.end()) found = presets_by_value.insert(found, {value, {}});
      found->second.emplace_back(preset.name);
    }
  }
  std::string text;
  for (const auto& [value, presets] : presets_by_value) text += fmt::format("; {} for {}", value, JoinWithAnd(presets));
  return text;
}

}  // namespace

const std::vector<OptionDescription>& DescribeTrainOptions() {
  static const std::vector<OptionDescription> descriptions = [] {
    std::vector<OptionDescription> all = DescribeTable<TrainOptions>(kTrainTable);
    for (OptionDescription& option : all) option.default_value += OtherDefaults(option.name);
    return all;
  }();
  return descriptions;
}

}  // namespace canonpose
