// The starter: a crude single-view lifter for people of whom nothing is known yet, trained once on simulated people.
// Self-calibration aligns its poses between views to begin with. It comes with the program: `scripts/make-starter`
// trains it by StarterRecipe::Default() and writes starter/starter.cpm, which the program holds. No LibTorch in this
// header.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "canonpose/data/dataset.h"
#include "canonpose/model/model_file.h"
#include "canonpose/simulate/wild_capture.h"
#include "canonpose/skeleton/skeleton.h"
#include "canonpose/train/options.h"

namespace canonpose {

/// h36m-17: any person's joints map onto it as `import` maps them (skeleton/mapping.h). Joints that a recording lacks
/// are missing in the starter's input.
const Skeleton& StarterSkeleton();

/// Whether the joints are a person's that map onto the starter's: the root, the hips, knees, shoulders and elbows of
/// both sides, and two thirds of all joints.
bool StarterKnows(const Skeleton& skeleton);

/// The starter that comes with the program. Throws Error(kBadInput) where the program itself is damaged.
ModelFile BuiltinStarter();

/// How the starter is trained.
struct StarterRecipe {
  WildCaptureOptions capture;  ///< of one layout; its layout is one of `layouts`
  /// The detectors' layouts that people are seen with, a capture each: derived joints lie elsewhere for each of them.
  /// "": the detector finds h36m-17's own joints.
  std::vector<std::string> layouts;
  TrainOptions training;

  /// About ten minutes of work for one core.
  static StarterRecipe Default();

  /// All that the result depends on, as JSON.
  [[nodiscard]] std::string ToJson() const;
};

/// The simulated people that the starter learns from.
Dataset StarterPeople(const StarterRecipe& recipe);

/// Trains into `run_folder`; model.cpm there is the starter. False where it was asked to stop before the end.
/// With the same recipe it has the same bits on machines of one kind.
bool TrainStarter(const StarterRecipe& recipe, const std::filesystem::path& run_folder);

/// What tells whether a starter is the one that a recipe makes, without training it anew. Figures may differ by about
/// 1e-4 between machines of different kinds.
struct StarterCard {
  std::string recipe;                ///< StarterRecipe::ToJson()
  std::vector<double> people;        ///< of each layout: mean distance of keypoints and of joints from the camera
  double brief_loss = 0.0;           ///< validation loss after a thousandth of the training
  std::vector<double> unseen_error;  ///< of each layout: loss of the starter itself on people it has not seen

  [[nodiscard]] std::string ToJson() const;
  /// Throws Error(kBadInput) naming `file` where the text is not a card.
  static StarterCard FromJson(const std::string& text, const std::string& file);
};

StarterCard MakeStarterCard(const StarterRecipe& recipe, const ModelFile& starter);

/// The card of the starter that comes with the program, as `scripts/make-starter` wrote it beside the model.
StarterCard BuiltinStarterCard();

}  // namespace canonpose
