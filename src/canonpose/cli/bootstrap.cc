#include "canonpose/cli/bootstrap.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/lift/lifter.h"
#include "canonpose/solve/factorisation.h"
#include "canonpose/train/starter.h"
#include "canonpose/train/trainer.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

/// A folder that is removed with all it holds.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string pattern = (fs::temp_directory_path() / "canonpose-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) {
      ThrowBadInput({pattern, "", "a temporary folder that can be written", "none", "set TMPDIR to one"});
    }
    path_ = pattern;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

StartPoses LiftAll(const PoseLifter& lifter, const Dataset& dataset, const std::string& file) {
  lifter.RequireSkeleton(dataset.skeleton, file);
  StartPoses start;
  for (const Sequence& sequence : dataset.sequences) {
    start.sequences.emplace_back();
    for (const CameraView& view : sequence.cameras) {
      start.sequences.back().push_back(lifter.Lift(view, sequence.frame_count).pose_in_camera);
    }
  }
  return start;
}

StartPoses BootstrapByMethod(const Dataset& dataset, const std::string& file, const BootstrapOptions& options) {
  std::optional<ScratchFolder> scratch;
  TrainJob job;
  job.datasets = {dataset};
  job.data_files = {file};
  job.options = PresetOptions("plus");
  job.options.seed = options.seed;
  job.options.threads = options.threads;
  job.options.device = options.device;
  job.run_folder = options.run_folder.empty() ? scratch.emplace().path() : options.run_folder;
  job.resume = true;
  LogInfo("training a lifter on {} itself by the method, to start from", file);
  const TrainReport report = Train(job);
  if (report.interrupted_by != 0) ThrowComputation("interrupted while training the lifter to start from");
  return LiftAll(PoseLifter::Open(job.run_folder, options.device), dataset, file);
}

}  // namespace

StartPoses Bootstrap(const Dataset& dataset, const std::string& file, const BootstrapOptions& options) {
  if (!options.model.empty()) return LiftAll(PoseLifter::Open(options.model, options.device), dataset, file);
  const bool knows = StarterKnows(dataset.skeleton);
  const bool stands = std::ranges::all_of(dataset.sequences, &Sequence::static_cameras);
  if (options.kind == "starter" && !knows) {
    ThrowBadInput({file, "/skeleton", "a person's joints, by the names of a built-in skeleton",
                   fmt::format("{}", fmt::join(dataset.skeleton.joints, ", ")),
                   "choose another --bootstrap, or name a model that was trained on such data"});
  }
  if (options.kind == "factorisation" || (options.kind == "auto" && !knows && stands)) {
    return FactorisedStart(dataset, file);
  }
  if (options.kind == "method" || !knows) return BootstrapByMethod(dataset, file, options);
  StarterOptions starter;
  starter.seed = options.seed;
  starter.threads = 1;  // its batches are small: more would be slower, and change the last bits
  starter.layout = dataset.source.layout;
  return LiftAll(PoseLifter::Open(StarterModel(dataset.skeleton, starter), options.device), dataset, file);
}

}  // namespace canonpose
