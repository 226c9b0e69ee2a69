#include "canonpose/train/starter.h"

#include <iterator>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/error.h"
#include "canonpose/train/trainer.h"

// The two files that scripts/make-starter writes into the source folder, built in by starter_files.S.
extern "C" {
extern const char canonpose_starter_begin[];
extern const char canonpose_starter_end[];
extern const char canonpose_starter_card_begin[];
extern const char canonpose_starter_card_end[];
}

namespace canonpose {
namespace {

using Json = nlohmann::ordered_json;

/// Raise it when a change of training changes what a recipe gives; StarterCard notices changes of the simulator.
constexpr int kRecipeVersion = 2;

Json DescribePeople(const WildCaptureOptions& capture) {
  const WildOptions& w = capture.wild;
  const DetectorOptions& d = capture.detector;
  return {{"clips", capture.clips},
          {"frames", capture.frames},
          {"fps", capture.fps},
          {"cameras", capture.cameras},
          {"off_centre", capture.off_centre},
          {"wild_share", capture.wild_share},
          {"mixed_share", capture.mixed_share},
          {"confidence_spread", capture.confidence_spread},
          {"wild",
           {{"arms_raised", w.arms_raised},
            {"arms_anywhere", w.arms_anywhere},
            {"legs_anywhere", w.legs_anywhere},
            {"trunk_bent", w.trunk_bent},
            {"leaning", w.leaning},
            {"tumbled", w.tumbled},
            {"arm_noise_deg", w.arm_noise_deg},
            {"leg_noise_deg", w.leg_noise_deg},
            {"hinge_noise_deg", w.hinge_noise_deg},
            {"trunk_noise_deg", w.trunk_noise_deg}}},
          {"detector",
           {{"noise", d.noise},
            {"jitter", d.jitter},
            {"occlusion", d.occlusion},
            {"swaps", d.swaps},
            {"outliers", d.outliers},
            {"missed_joints", d.missed_joints},
            {"missed_frames", d.missed_frames},
            {"confidence", d.confidence},
            {"joint_offset", d.joint_offset},
            {"sync_jitter", d.sync_jitter}}},
          {"seed", capture.seed}};
}

}  // namespace

const Skeleton& StarterSkeleton() { return *FindSkeleton("h36m-17"); }

bool StarterKnows(const Skeleton& skeleton) { return IsKnownPerson(skeleton); }

ModelFile BuiltinStarter() {
  return ReadModelImage({canonpose_starter_begin, canonpose_starter_end}, "the starter in this program");
}

StarterCard BuiltinStarterCard() {
  return StarterCard::FromJson({canonpose_starter_card_begin, canonpose_starter_card_end},
                               "the starter's card in this program");
}

StarterRecipe StarterRecipe::Default() {
  StarterRecipe recipe;
  recipe.layouts = {"", "body_25", "body_25b", "coco-18", "coco-17", "halpe-26", "canonpose-16", "mpii-16"};
  // Every pose is seen once: one more person teaches more than one more view.
  recipe.capture.cameras = 1;
  recipe.capture.clips = 1500;
  recipe.training = PresetOptions("supervised");
  recipe.training.preset = "starter";
  static constexpr std::pair<const char*, const char*> kSettings[] = {
      {"width", "256"},
      {"batch_frames", "128"},
      {"learning_rate", "0.002"},
      {"epochs", "12"},
      {"validation", "0"},
      {"checkpoint_seconds", "1000000"},
      {"ray", "root"},
      {"schedule", "cosine"},
      {"joint_dropout", "0.3"},
      {"threads", "1"},
      {"input_confidences", "missing"},
  };
  for (const auto& [name, value] : kSettings) recipe.training.Set(name, value);
  return recipe;
}

std::string StarterRecipe::ToJson() const {
  const Json json = {{"version", kRecipeVersion},
                     {"layouts", layouts},
                     {"people", DescribePeople(capture)},
                     {"training", Json::parse(training.ToJson(/*only_what_changes_results=*/true))}};
  return json.dump();
}

Dataset StarterPeople(const StarterRecipe& recipe) {
  Dataset people;
  for (std::size_t i = 0; i < recipe.layouts.size(); ++i) {
    WildCaptureOptions capture = recipe.capture;
    capture.layout = recipe.layouts[i];
    capture.seed = recipe.capture.seed * recipe.layouts.size() + i;
    Dataset part = MakeWildCapture(StarterSkeleton(), capture);
    if (i == 0) {
      people = std::move(part);
    } else {
      people.sequences.insert(people.sequences.end(), std::make_move_iterator(part.sequences.begin()),
                              std::make_move_iterator(part.sequences.end()));
    }
  }
  return people;
}

bool TrainStarter(const StarterRecipe& recipe, const std::filesystem::path& run_folder) {
  TrainJob job;
  job.datasets.push_back(StarterPeople(recipe));
  job.data_files = {"simulated people"};
  job.options = recipe.training;
  job.run_folder = run_folder;
  job.overwrite = true;
  return !Train(job).stopped;
}

}  // namespace canonpose
