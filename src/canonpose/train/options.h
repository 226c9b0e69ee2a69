// Every option of training in one plain struct. One table of its fields (options.cc) serves parsing, validation, the
// JSON record in model files and checkpoints, the command line's help and docs/training-options.md.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "canonpose/base/enum_names.h"
#include "canonpose/model/model_form.h"
#include "canonpose/train/option_description.h"

namespace canonpose {

/// How the learning rate falls.
enum class RateSchedule { kSteps, kCosine };

template <>
inline constexpr std::array kEnumNames<RateSchedule>{
    EnumName{RateSchedule::kSteps, "steps", "times 0.1 after 30, 60 and 90 % of the epochs, as published"},
    EnumName{RateSchedule::kCosine, "cosine", "half a cosine down to 0"}};

/// What a lifter learns from.
enum class Supervision { kNone, kTruth, kSolved, kTriangulated };

template <>
inline constexpr std::array kEnumNames<Supervision>{
    EnumName{Supervision::kNone, "none", "the views alone"},
    EnumName{Supervision::kTruth, "truth", "the dataset's true 3D poses, which show what could be reached"},
    EnumName{Supervision::kSolved, "solved", "the 3D poses that `canonpose solve` found from all views"},
    EnumName{Supervision::kTriangulated, "triangulated",
             "3D poses triangulated with the dataset's calibration, as in EpipolarPose (Kocabas et al., CVPR 2019)"}};

/// What self-calibration starts from.
enum class BootstrapKind { kAuto, kStarter, kMethod, kFactorisation };

template <>
inline constexpr std::array kEnumNames<BootstrapKind>{
    EnumName{BootstrapKind::kAuto, "auto",
             "the starter where it knows the joints, otherwise factorisation or, where cameras move, the method"},
    EnumName{BootstrapKind::kStarter, "starter", "a lifter trained on simulated people, which comes with the program"},
    EnumName{BootstrapKind::kMethod, "method", "a lifter trained on the data themselves with preset plus"},
    EnumName{BootstrapKind::kFactorisation, "factorisation", "no lifter; static cameras, any body"}};

/// How views, and frames of static cameras, are made to agree.
enum class Consistency {
  kMixing,  ///< the method: poses and rotations are exchanged between views and frames, then reprojected
  /// Instead of exchanging views: mean |X_s - X_t| over the joints and axes of two canonical poses of a frame.
  kEqualPoses,
  /// Instead of exchanging frames: mean |R_t R_s^T - R[to] R[from]^T| over the elements.
  kEqualCameras,
};

template <>
inline constexpr std::array kEnumNames<Consistency>{
    EnumName{Consistency::kMixing, "mixing", "poses and rotations are exchanged between views and frames, the method"},
    EnumName{Consistency::kEqualPoses, "equal_poses",
             "an ablation: view consistency penalises differences between the canonical poses of a frame"},
    EnumName{Consistency::kEqualCameras, "equal_cameras",
             "an ablation: camera consistency penalises differences between the relative rotations of two frames"}};

/// Which frames share the relative rotations of their cameras.
enum class CameraConsistency { kOff, kStatic, kWindow };

template <>
inline constexpr std::array kEnumNames<CameraConsistency>{
    EnumName{CameraConsistency::kOff, "off", "none"},
    EnumName{CameraConsistency::kStatic, "static", "those of a capture, where its cameras are static"},
    EnumName{CameraConsistency::kWindow, "window",
             "those of a sequence that are close in time, since even moving cameras rotate little meanwhile"}};

enum class PerspectiveForm { kOff, kLearned };

template <>
inline constexpr std::array kEnumNames<PerspectiveForm>{
    EnumName{PerspectiveForm::kOff, "off", "weak perspective, as published"},
    EnumName{PerspectiveForm::kLearned, "learned", "one perspective factor k, learned with the network"}};

/// Which of the two mirror images a lifter that learned from views alone is to be.
enum class MirrorHandling { kAuto, kKeep, kFlip };

template <>
inline constexpr std::array kEnumNames<MirrorHandling>{
    EnumName{MirrorHandling::kAuto, "auto", "the one that perspective in the data supports"},
    EnumName{MirrorHandling::kKeep, "keep", "the one that training found"},
    EnumName{MirrorHandling::kFlip, "flip", "the other one"}};

/// What each option means: DescribeTrainOptions() and docs/training-options.md.
struct TrainOptions {
  /// The name of the preset that the options came from, for the record: it does nothing by itself.
  std::string preset = "none";

  // How long, and with which steps.
  int epochs = 0;
  int default_epochs = 100;
  int min_steps = 3000;
  LifterKind network = LifterKind::kCanonical;
  int width = 1024;
  int batch_frames = 32;
  double learning_rate = 1e-4;
  double weight_decay = 1e-5;
  RateSchedule schedule = RateSchedule::kSteps;

  // What is learned from, and what the network sees.
  Supervision supervision = Supervision::kNone;
  /// Not used by Train(): how data that are not solved yet are to be solved before.
  BootstrapKind bootstrap = BootstrapKind::kAuto;
  ConfidenceInput input_confidences = ConfidenceInput::kAll;
  bool loss_confidences = true;
  Consistency consistency = Consistency::kMixing;
  RayForm ray = RayForm::kOff;
  FocalSource focal = FocalSource::kGuess;
  RotationForm rotation = RotationForm::kAxisAngle;

  // With supervision only.
  double new_views = 0.0;
  double flips = 0.0;
  double joint_dropout = 0.0;
  bool uncertainty_weights = false;

  // Without supervision only.
  double view_weight = 1.0;
  double camera_weight = 0.1;
  CameraConsistency camera_consistency = CameraConsistency::kOff;
  double camera_window_seconds = 3.0;
  double camera_window_end = 0.5;
  double rotation_spread = 1.0;
  int restarts = 1;
  int restart_steps = 1000;
  PerspectiveForm perspective = PerspectiveForm::kOff;
  double perspective_warmup = 0.3;
  double perspective_learning_rate = 0.01;
  MirrorHandling mirror = MirrorHandling::kAuto;

  double validation = 0.1;
  std::uint64_t seed = 0;

  // About the machine: a resumed run may change them.
  int threads = 0;
  std::string device = "cpu";
  double checkpoint_seconds = 30.0;

  [[nodiscard]] bool is_supervised() const { return supervision != Supervision::kNone; }

  /// Throws Error(kInvalidArgument) naming the first option that is out of range or does not go with another.
  void Validate() const;

  /// An object with the fields in the order of the table; choices are words.
  [[nodiscard]] std::string ToJson(bool only_what_changes_results = false) const;
  /// Missing fields keep their defaults. Throws Error(kBadInput) naming `file` where the text is damaged.
  static TrainOptions FromJson(const std::string& json, const std::string& file);

  /// Whether there is a field of this name.
  static bool Has(const std::string& name);
  /// Sets one field by name, except the preset, which stands for a choice of all fields (PresetOptions()). Throws
  /// Error(kInvalidArgument) for an unknown name (listing the known ones), a value that does not parse, or 0 epochs:
  /// the field is 0 only where nobody set it.
  void Set(const std::string& name, const std::string& value);
  [[nodiscard]] std::string Get(const std::string& name) const;

  /// The names of the fields in which `other` differs, except those about the machine. Of these checkpoint_seconds
  /// never changes a result; the others may, in the last bits.
  [[nodiscard]] std::vector<std::string> Differences(const TrainOptions& other) const;
};

/// A choice of options that go together.
struct Preset {
  const char* name;
  const char* description;
  /// The fields whose values are not the defaults, as TrainOptions::Set() takes them.
  std::vector<std::pair<const char*, const char*>> differences;
};

const std::vector<Preset>& Presets();

/// The options of a preset. Throws Error(kInvalidArgument) for an unknown name.
TrainOptions PresetOptions(const std::string& preset);

/// "paper, paper+c, plus, supervised, martinez, epipolar, best"
std::string PresetNames();

/// All options in the order of the table, with their defaults in each preset.
const std::vector<OptionDescription>& DescribeTrainOptions();

}  // namespace canonpose
