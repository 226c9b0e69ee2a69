// The starter: a crude single-view lifter for people of whom nothing is known yet, trained once on simulated people and
// kept in a cache. Self-calibration aligns its poses between views to begin with. No LibTorch in this header.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "canonpose/simulate/wild_capture.h"
#include "canonpose/skeleton/skeleton.h"
#include "canonpose/train/options.h"

namespace canonpose {

/// How the starter is trained.
struct StarterRecipe {
  WildCaptureOptions capture;  ///< its seed, layout and threads are those of StarterOptions
  TrainOptions training;       ///< its seed and threads likewise

  /// About a minute of work for two cores.
  static StarterRecipe Default();
};

struct StarterOptions {
  std::uint64_t seed = 0;
  int threads = 0;  ///< 0: all
  /// Where trained starters are kept; empty: canonpose/ in $XDG_CACHE_HOME or in ~/.cache.
  std::filesystem::path cache_folder;
  /// The detector's layout that the recording was mapped from (DatasetSource::layout): its derived joints lie elsewhere
  /// than the skeleton's own. Empty, or not built in: the skeleton's own.
  std::string layout;
  StarterRecipe recipe = StarterRecipe::Default();
};

/// Whether the skeleton's joints are a person's that the simulator knows by name: the root, the hips, knees, shoulders
/// and elbows of both sides, and two thirds of all joints.
bool StarterKnows(const Skeleton& skeleton);

/// The starter's model file for the joints of `skeleton`: found in the cache, or trained now, with progress, and kept
/// there. It lifts joints that the simulator does not know to NaN, and takes no notice of them in its input.
///
/// The file's name is a hash of all that the result depends on: joints, seed, layout, recipe, and the simulator's own
/// work on the recipe. With one thread and the same seed a model has the same bits; more threads may change the last
/// ones, and are no part of the name. Programs that train the same one at a time do not disturb each other.
///
/// A damaged entry is replaced, with a warning. Where the cache cannot be written, the model lies in a temporary folder
/// until the program ends, and there is one warning. Throws Error(kBadInput) where StarterKnows() is false. SIGINT and
/// SIGTERM end the program once nothing temporary is left; Error(kComputation) where the program ignores or handles
/// them itself.
std::filesystem::path StarterModel(const Skeleton& skeleton, const StarterOptions& options);

}  // namespace canonpose
