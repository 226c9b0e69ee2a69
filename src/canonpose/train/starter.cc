#include "canonpose/train/starter.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/base/hash.h"
#include "canonpose/base/log.h"
#include "canonpose/model/model_file.h"
#include "canonpose/model/tensors.h"
#include "canonpose/train/trainer.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

/// To be raised where training itself changes what a recipe gives; changes of the simulator are noticed.
constexpr int kRecipeVersion = 1;

// --- what the result depends on -------------------------------------------------------------------------------------

template <typename Number>
void AddNumbers(const std::vector<Number>& numbers, Fingerprint& fingerprint) {
  fingerprint.Add(numbers.data(), numbers.size() * sizeof(Number));
}

/// The recipe with what the caller's options say.
StarterRecipe ResolveRecipe(const StarterOptions& options) {
  StarterRecipe recipe = options.recipe;
  recipe.capture.seed = options.seed;
  recipe.capture.threads = options.threads;
  recipe.capture.layout = FindSkeleton(options.layout) != nullptr ? options.layout : "";
  recipe.training.seed = options.seed;
  recipe.training.threads = options.threads;
  return recipe;
}

/// Clips that are made to see whether the simulator still does the same: two of each activity.
constexpr int kSampleClips = 20;

std::vector<double> NumbersOf(const WildCaptureOptions& capture) {
  const WildOptions& w = capture.wild;
  const DetectorOptions& d = capture.detector;
  return {capture.off_centre,
          capture.wild_share,
          capture.mixed_share,
          capture.confidence_spread,
          w.arms_raised,
          w.arms_anywhere,
          w.legs_anywhere,
          w.trunk_bent,
          w.leaning,
          w.tumbled,
          w.arm_noise_deg,
          w.leg_noise_deg,
          w.hinge_noise_deg,
          w.trunk_noise_deg,
          d.noise,
          d.jitter,
          d.occlusion,
          d.swaps,
          d.outliers,
          d.missed_joints,
          d.missed_frames,
          d.confidence,
          d.joint_offset,
          d.sync_jitter};
}

std::uint64_t KeyOf(const Skeleton& skeleton, const StarterRecipe& recipe) {
  const WildCaptureOptions& capture = recipe.capture;
  Fingerprint fingerprint;
  fingerprint.Add(fmt::format("starter {}", kRecipeVersion));
  for (const std::string& joint : skeleton.joints) fingerprint.Add(joint);
  AddNumbers(skeleton.parents, fingerprint);
  AddNumbers(skeleton.mirror, fingerprint);
  fingerprint.Add(fmt::format("root {} layout {} seed {}", skeleton.root, capture.layout, capture.seed));
  fingerprint.Add(fmt::format("{} clips of {} frames, {} a second, {} cameras", capture.clips, capture.frames,
                              capture.fps, capture.cameras));
  AddNumbers(NumbersOf(capture), fingerprint);
  fingerprint.Add(recipe.training.ToJson(/*only_what_changes_results=*/true));
  for (int n = 0; n < std::min(kSampleClips, capture.clips); ++n) {
    for (const CameraView& view : MakeWildClip(skeleton, capture, n).cameras) {
      AddNumbers(view.keypoints, fingerprint);
      AddNumbers(view.confidence, fingerprint);
      AddNumbers(view.truth, fingerprint);
    }
  }
  return fingerprint.value();
}

// --- folders --------------------------------------------------------------------------------------------------------

/// A new folder for temporary files, removed with all it holds.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string pattern = (fs::temp_directory_path() / "canonpose-starter-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) ThrowCannotWrite(pattern, errno);
    path_ = pattern;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  ScratchFolder(ScratchFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  ScratchFolder& operator=(ScratchFolder&&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Models that no cache could keep, until the program ends.
class KeptModels {
 public:
  static KeptModels& Instance() {
    static KeptModels models;
    return models;
  }
  std::optional<fs::path> Find(std::uint64_t key) {
    const std::lock_guard lock(mutex_);
    const auto found = folders_.find(key);
    if (found == folders_.end()) return std::nullopt;
    return found->second.path() / "model.cpm";
  }
  fs::path Keep(std::uint64_t key, ScratchFolder folder) {
    const std::lock_guard lock(mutex_);
    return folders_.try_emplace(key, std::move(folder)).first->second.path() / "model.cpm";
  }

 private:
  std::mutex mutex_;
  std::map<std::uint64_t, ScratchFolder> folders_;
};

/// Empty where the user has no folder for caches.
fs::path CacheFolder(const StarterOptions& options) {
  if (!options.cache_folder.empty()) return options.cache_folder;
  // The XDG specification has relative paths ignored.
  const char* cache = std::getenv("XDG_CACHE_HOME");
  if (cache != nullptr && fs::path(cache).is_absolute()) return fs::path(cache) / "canonpose";
  const char* home = std::getenv("HOME");
  if (home != nullptr && fs::path(home).is_absolute()) return fs::path(home) / ".cache" / "canonpose";
  return {};
}

/// Whether the file is a starter for these joints that can be used; warns where it is none.
bool IsSound(const fs::path& path, const Skeleton& skeleton) {
  std::error_code error;
  if (!fs::exists(path, error)) return false;
  try {
    const ModelFile model = ReadModelFile(path);
    MakeLifter(model, path.string(), torch::kCPU);
    if (model.info.skeleton.SameJoints(skeleton)) return true;
    LogWarning("{} is a model for other joints; training the starter again", path.string());
  } catch (const Error& damage) {
    LogWarning("training the starter again: {}", damage.what());
  }
  return false;
}

/// Copies the model into the cache; false, with a warning, where that cannot be.
bool Store(const fs::path& model, const fs::path& entry) {
  try {
    if (entry.empty()) throw Error(ExitCode::kBadInput, "neither XDG_CACHE_HOME nor HOME says where");
    MakeDirectory(entry.parent_path());
    WriteFileAtomically(entry, ReadFile(model));
    return true;
  } catch (const Error& error) {
    LogWarning("the starter cannot be kept for the next time: {}", error.what());
    return false;
  }
}

// --- training -------------------------------------------------------------------------------------------------------

/// Makes a model deaf to joints it has never seen, and lifts them to NaN.
void SilenceUnknownJoints(const fs::path& path, const std::vector<std::uint8_t>& known) {
  if (std::find(known.begin(), known.end(), 0) == known.end()) return;
  ModelFile model = ReadModelFile(path);
  const std::size_t joints = known.size();
  std::vector<float>& input = model.parameters.at("upscale.weight").values;  // (width, 3J)
  std::vector<float>& bias = model.parameters.at("pose3d.bias").values;      // (3J) planar
  for (std::size_t i = 0; i < input.size(); ++i) {
    if (known[i % joints] == 0) input[i] = 0.0F;
  }
  for (std::size_t i = 0; i < bias.size(); ++i) {
    if (known[i % joints] == 0) bias[i] = std::numeric_limits<float>::quiet_NaN();
  }
  WriteModelFile(path, model);
}

/// Trains into `folder`; returns the signal that stopped it, 0 where none did.
int TrainStarter(const Skeleton& skeleton, const StarterRecipe& recipe, const fs::path& folder) {
  TrainJob job;
  job.datasets.push_back(MakeWildCapture(skeleton, recipe.capture));
  job.data_files = {"simulated people"};
  job.options = recipe.training;
  job.run_folder = folder;
  const TrainReport report = Train(job);
  if (report.interrupted_by == 0) SilenceUnknownJoints(folder / "model.cpm", KnownJointsOf(skeleton));
  return report.interrupted_by;
}

}  // namespace

StarterRecipe StarterRecipe::Default() {
  StarterRecipe recipe;
  // Every pose is seen once: another person teaches more than another view.
  recipe.capture.cameras = 1;
  recipe.capture.clips = 1500;
  recipe.training = PresetOptions("supervised");
  recipe.training.preset = "starter";
  static constexpr std::pair<const char*, const char*> kSettings[] = {
      {"width", "256"}, {"batch_frames", "128"}, {"learning_rate", "0.002"},
      {"epochs", "10"}, {"validation", "0"},     {"checkpoint_seconds", "1000000"},
      {"ray", "root"},  {"schedule", "cosine"},  {"joint_dropout", "0.15"},
  };
  for (const auto& [name, value] : kSettings) recipe.training.Set(name, value);
  return recipe;
}

bool StarterKnows(const Skeleton& skeleton) { return IsKnownPerson(skeleton); }

fs::path StarterModel(const Skeleton& skeleton, const StarterOptions& options) {
  const StarterRecipe recipe = ResolveRecipe(options);
  recipe.training.Validate();
  const std::uint64_t key = KeyOf(skeleton, recipe);
  if (const std::optional<fs::path> kept = KeptModels::Instance().Find(key)) return *kept;
  const fs::path cache = CacheFolder(options);
  const fs::path entry = cache.empty() ? fs::path() : cache / fmt::format("starter-{:016x}.cpm", key);
  if (!entry.empty() && IsSound(entry, skeleton)) return entry;
  LogInfo("training a starter on simulated people, once for these joints (about a minute)");
  int signal = 0;
  {
    ScratchFolder folder;
    signal = TrainStarter(skeleton, recipe, folder.path());
    if (signal == 0) {
      if (Store(folder.path() / "model.cpm", entry)) return entry;
      return KeptModels::Instance().Keep(key, std::move(folder));
    }
  }
  // With nothing left behind, the program ends as it would without us, unless somebody listens.
  std::raise(signal);
  ThrowComputation("stopped while the starter was trained; run the same command again to train it anew");
}

}  // namespace canonpose
