// The starter: a rough single-view lifter for people nothing is known about yet, trained once on simulated people.
// Self-calibration starts by aligning its poses between views. It comes with the program: `scripts/make-starter` trains
// it by StarterRecipe::Default() and writes starter/starter.cpm, which is built into the program. No LibTorch in this
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

/// h36m-17: the joints of any detector map onto it as in an import (skeleton/mapping.h). Joints that a recording lacks
/// are missing in the starter's input.
const Skeleton& StarterSkeleton();

/// Whether the skeleton is a person's whose joints map onto the starter's: the root, both hips, knees, shoulders and
/// elbows, and two thirds of all joints.
bool StarterKnows(const Skeleton& skeleton);

/// The starter that comes with the program. Throws Error(kBadInput) where the program itself is damaged.
ModelFile BuiltinStarter();

/// How the starter is trained.
struct StarterRecipe {
  WildCaptureOptions capture;  ///< for each of `layouts`, which take the place of its layout
  /// The detectors' layouts that people are seen with, one capture per layout: the joints derived from them lie in
  /// different places. "": the detector finds h36m-17's own joints.
  std::vector<std::string> layouts;
  TrainOptions training;

  /// It takes about ten minutes on one core.
  static StarterRecipe Default();

  /// Everything the result depends on, as JSON.
  [[nodiscard]] std::string ToJson() const;
};

/// The simulated people that the starter learns from.
Dataset StarterPeople(const StarterRecipe& recipe);

/// Trains into `run_folder`, whose model.cpm is then the starter. False where it was asked to stop before the end. The
/// same recipe gives the same bits on machines of one kind.
bool TrainStarter(const StarterRecipe& recipe, const std::filesystem::path& run_folder);

/// Shows whether a starter is the one that a recipe makes, without training it again. The numbers may differ by about
/// 1e-4 between machines of different kinds.
struct StarterCard {
  std::string recipe;                ///< StarterRecipe::ToJson()
  std::vector<double> people;        ///< per layout: mean distance of keypoints and of joints from the origin
  double brief_loss = 0.0;           ///< validation loss after a thousandth of the training
  std::vector<double> unseen_error;  ///< per layout: loss of the starter itself on people it was not trained on

  [[nodiscard]] std::string ToJson() const;
  /// Throws Error(kBadInput) naming `file` where the text is not a card.
  static StarterCard FromJson(const std::string& text, const std::string& file);
};

StarterCard MakeStarterCard(const StarterRecipe& recipe, const ModelFile& starter);

/// The card of the starter that comes with the program, as `scripts/make-starter` wrote it beside the model.
StarterCard BuiltinStarterCard();

}  // namespace canonpose
