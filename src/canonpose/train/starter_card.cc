#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "canonpose/base/error.h"
#include "canonpose/model/tensors.h"
#include "canonpose/train/augmentation.h"
#include "canonpose/train/losses.h"
#include "canonpose/train/starter.h"
#include "canonpose/train/trainer.h"
#include "canonpose/train/training_set.h"

namespace canonpose {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kClipsOfALayout = 4;
constexpr int kBriefEpochs = 4;
/// People of other seeds than the recipe's are unseen.
constexpr std::uint64_t kUnseenSeed = 1'000'000;

StarterRecipe Brief(StarterRecipe recipe) {
  recipe.capture.clips = kClipsOfALayout;
  recipe.training.epochs = kBriefEpochs;
  recipe.training.validation = 0.1;
  return recipe;
}

/// One recipe for each layout.
std::vector<StarterRecipe> ByLayout(const StarterRecipe& recipe) {
  std::vector<StarterRecipe> recipes;
  for (const std::string& layout : recipe.layouts) {
    recipes.push_back(recipe);
    recipes.back().layouts = {layout};
  }
  return recipes;
}

/// Mean distance from the origin of the keypoints, in pixels, and of the joints, in millimetres.
std::pair<double, double> MeanDistances(const Dataset& dataset) {
  double keypoints = 0.0;
  double joints = 0.0;
  std::size_t count = 0;
  for (const Sequence& sequence : dataset.sequences) {
    for (const CameraView& view : sequence.cameras) {
      for (std::size_t i = 0; i < view.confidence.size(); ++i) {
        const double pixel = std::hypot(view.keypoints[2 * i], view.keypoints[2 * i + 1]);
        const float* const joint = &view.truth.positions()[3 * i];
        const double mm = std::hypot(joint[0], joint[1], joint[2]);
        if (!std::isfinite(pixel) || !std::isfinite(mm)) continue;
        keypoints += pixel;
        joints += mm;
        ++count;
      }
    }
  }
  CANONPOSE_CHECK(count > 0);
  return {keypoints / static_cast<double>(count), joints / static_cast<double>(count)};
}

double SupervisedLossOf(const ModelFile& starter, const Dataset& dataset, const TrainOptions& options) {
  const TrainingSplit split = MakeTrainingSplit({dataset}, 0.0, RowFormOf(options));
  const auto network = MakeLifter(starter, "starter", torch::kCPU);
  const auto loss = [&](const std::vector<const TrainingFrame*>& frames) {
    const BatchTensors batch = GatherBatch(split.training, frames, torch::kCPU);
    return ComputeSupervisedLoss(network->forward(LifterInput(batch)), batch, dataset.skeleton.root);
  };
  return MeanLosses(split.training, 1, loss).total.item<double>();
}

}  // namespace

std::string StarterCard::ToJson() const {
  const Json json = {
      {"recipe", Json::parse(recipe)}, {"people", people}, {"brief_loss", brief_loss}, {"unseen_error", unseen_error}};
  return json.dump(1) + "\n";
}

StarterCard StarterCard::FromJson(const std::string& text, const std::string& file) {
  try {
    const Json json = Json::parse(text);
    return {json.at("recipe").dump(), json.at("people").get<std::vector<double>>(), json.at("brief_loss").get<double>(),
            json.at("unseen_error").get<std::vector<double>>()};
  } catch (const Json::exception&) {
    ThrowBadInput({file, "", "the card of a starter as JSON", "another text", "make it again: scripts/make-starter"});
  }
}

StarterCard MakeStarterCard(const StarterRecipe& recipe, const ModelFile& starter) {
  StarterCard card;
  card.recipe = recipe.ToJson();
  const StarterRecipe brief = Brief(recipe);
  for (const StarterRecipe& one : ByLayout(brief)) {
    const auto [keypoints, joints] = MeanDistances(StarterPeople(one));
    card.people.insert(card.people.end(), {keypoints, joints});
    StarterRecipe unseen = one;
    unseen.capture.seed = kUnseenSeed;
    card.unseen_error.push_back(SupervisedLossOf(starter, StarterPeople(unseen), recipe.training));
  }
  TrainJob job;
  job.datasets.push_back(StarterPeople(brief));
  job.data_files = {"simulated people"};
  job.options = brief.training;
  card.brief_loss = Train(job).validation_loss.value();
  return card;
}

}  // namespace canonpose
