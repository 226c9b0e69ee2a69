// Every option of training in one plain struct; one list of fields drives the command line, the JSON record and the
// checkpoint.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace canonpose {

struct TrainOptions {
  std::string preset =
      "best";      ///< what the others were set by: paper, paper+c, plus, supervised, martinez, epipolar, best
  int epochs = 0;  ///< 0: `default_epochs`, more where `min_steps` asks for it
  int default_epochs = 100;
  int min_steps = 0;                  ///< a small recording is gone through more often until this many steps are taken
  std::string network = "canonical";  ///< canonical: the method's; martinez: a supervised baseline's, which answers a
                                      ///< pose in the camera alone (model/martinez_lifter.h)
  int width = 1024;                   ///< of the network's layers
  int batch_frames = 32;              ///< frames a step, each with all its views
  double learning_rate = 1e-4;        ///< at the start
  std::string schedule = "steps";  ///< of the rate, steps: x 0.1 after 30, 60 and 90 % of the epochs; cosine: down to 0
  double weight_decay = 1e-5;      ///< L2, added to the gradient
  std::string supervision = "none";  ///< none: the views alone; solved: the 3D poses that `solve` found from all views;
                                     ///< truth: the dataset's true ones, as a measure of what could be had;
                                     ///< triangulated: what the dataset's calibration makes of its keypoints, as
                                     ///< EpipolarPose learns (Kocabas et al., CVPR 2019)
  /// Of preset best, for data not solved yet: what they are solved from. starter: a lifter trained on simulated people;
  /// method: one trained on the data by the method; factorisation: none, for static cameras; auto: the starter where it
  /// knows the joints, otherwise factorisation or, where cameras move, the method
  std::string bootstrap = "auto";
  /// on: the network sees confidences, as published; missing: which joints it missed, the pose scaled up
  /// (model/lifter.h); off: 2D coordinates alone
  std::string input_confidences = "on";
  std::string loss_confidences = "on";  ///< off: all joints that are seen count the same in the loss
  /// mixing: poses and rotations are mixed over views and frames, as the method does. Ablations of it: equal_poses,
  /// where view consistency asks the canonical poses of a frame to be equal instead; equal_cameras, where camera
  /// consistency asks the relative rotations of two frames to be equal
  std::string consistency = "mixing";
  std::string ray = "off";  ///< root: the root's viewing ray is turned onto the optical axis (model/pose_input.h)
  std::string focal =
      "guess";  ///< for that, guess: from the image size; known: solved or calibrated where there is one
  std::string rotation = "axis_angle";  ///< form of the network's rotations: axis_angle, 6d (model/lifter.h)
  double new_views = 0.0;      ///< share of poses seen from a new camera (train/new_views.h); needs supervision
  double flips = 0.0;          ///< probability that a pose is mirrored left-right; needs supervision
  double joint_dropout = 0.0;  ///< probability that a pose loses one to four joints; needs supervision
  /// on: with supervision=solved a joint counts the less the less sure it is, 1 / (1 + (s / median s)^2) with s the
  /// uncertainty of a joint relative to the size of its pose
  std::string uncertainty_weights = "off";
  double view_weight = 1.0;    ///< weight of view consistency
  double camera_weight = 0.1;  ///< weight of camera consistency
  /// off; static: for captures whose cameras stand still; window: for all, among frames of a sequence that are not far
  /// apart, while which even moving cameras turn little
  std::string camera_consistency = "off";
  double camera_window_seconds = 3.0;  ///< window: its length at first, in seconds
  double camera_window_end = 0.5;      ///< share of the steps by which its length and its weight have fallen to zero
  double rotation_spread = 1.0;        ///< the rotation layer's initial weights are multiplied by it
  int restarts = 1;                    ///< short runs from different seeds, of which the best is gone on with
  /// Length of each of them. At 500 steps a run that will be trapped still has the lesser loss (docs/results.md).
  int restart_steps = 1000;
  std::string perspective = "off";          ///< off: weak perspective as published; learned: one factor k, learned
  double perspective_warmup = 0.3;          ///< share of the steps before k is set free
  double perspective_learning_rate = 0.01;  ///< of k alone
  std::string mirror = "auto";              ///< auto: by the perspective slope; keep, flip: by request
  double validation = 0.1;                  ///< share of the frames held out, at the end of every 50
  std::uint64_t seed = 0;
  /// Of the network, 0: one. What `best` does before training takes all cores where it is 0.
  int threads = 0;
  std::string device = "cpu";
  double checkpoint_seconds = 30.0;  ///< time between checkpoints; the result does not depend on it

  /// Throws Error(kInvalidArgument) naming the first option that is out of range.
  void Validate() const;

  /// "learning_rate=0.0001" ... in the order of the fields.
  [[nodiscard]] std::string ToJson(bool only_what_changes_results = false) const;
  /// What is missing keeps its default. Throws Error(kBadInput) naming `file` where the text is damaged.
  static TrainOptions FromJson(const std::string& json, const std::string& file);

  /// Sets one field by name; the preset is no field but a choice of all of them (PresetOptions()). Throws
  /// Error(kInvalidArgument) for an unknown name (listing the known ones) or a value that does not parse. Whether there
  /// is a field of this name.
  static bool Has(const std::string& name);
  void Set(const std::string& name, const std::string& value);

  /// The names of the fields in which `other` differs, except those that are about the machine (device, threads,
  /// checkpoint_seconds). The last of them never changes a result; the others may, in the last bits.
  [[nodiscard]] std::vector<std::string> Differences(const TrainOptions& other) const;
  [[nodiscard]] std::string Get(const std::string& name) const;
};

/// The options of a preset. Throws Error(kInvalidArgument) for an unknown name.
///
///   paper    the method as published, without camera consistency; the mirror is decided once, at the end
///   paper+c  paper with camera consistency
///   plus     paper+c where cameras are static, with the learned perspective factor, a quarter of the width and a
///   higher learning rate
///   supervised  the same lifter trained with the dataset's true 3D poses: what the others are measured against
///   martinez    the network of Martinez et al. (ICCV 2017), trained with the true 3D poses
///   epipolar    the same lifter trained with poses that the dataset's calibration makes of its keypoints
///   best     a lifter trained with the 3D poses that `solve` found from all views, seen from many more views
///
/// All go through a small recording more often than 100 times, until 3000 steps are taken.
TrainOptions PresetOptions(const std::string& preset);

/// "paper, paper+c, plus, supervised, martinez, epipolar, best"
std::string PresetNames();

}  // namespace canonpose
