#include "canonpose/pipeline/solve_then_train.h"

#include <cstddef>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/data/merge.h"
#include "canonpose/pipeline/bootstrap.h"
#include "canonpose/solve/solver.h"
#include "canonpose/train/data_checks.h"
#include "canonpose/train/run_folder.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

fs::path SolvedFile(const TrainJob& job, std::size_t number) {
  return job.run_folder / fmt::format("solved-{}.h5", number);
}

/// Takes what an earlier part of the run solved. False, and nothing is changed, where any of it is missing or was
/// solved from other data.
bool TakeSolved(TrainJob& job, const std::vector<std::size_t>& numbers) {
  std::vector<Dataset> solved;
  for (const std::size_t number : numbers) {
    const fs::path file = SolvedFile(job, number);
    if (!fs::exists(file)) return false;
    solved.push_back(ReadDataset(file));
    if (solved.back().Fingerprint() == job.datasets[number].Fingerprint()) continue;
    LogInfo("{} was solved from other data: solving again", file.string());
    return false;
  }
  for (std::size_t i = 0; i < numbers.size(); ++i) job.datasets[numbers[i]] = std::move(solved[i]);
  return true;
}

/// Solves these datasets of the job, all together.
void SolveDatasets(TrainJob& job, const std::vector<std::size_t>& numbers) {
  std::vector<Dataset> datasets;
  std::vector<std::string> files;
  for (const std::size_t number : numbers) {
    datasets.push_back(job.datasets[number]);
    files.push_back(job.data_files[number]);
  }
  Dataset together = MergeDatasets(std::move(datasets), files);
  const bool writes = !job.run_folder.empty();
  BootstrapOptions bootstrap;
  bootstrap.kind = ToString(job.options.bootstrap);
  if (writes) bootstrap.run_folder = job.run_folder / "bootstrap";
  bootstrap.seed = job.options.seed;
  bootstrap.threads = job.options.threads;
  bootstrap.device = job.options.device;
  if (writes && !job.resume) fs::remove_all(bootstrap.run_folder);
  const StartPoses start = Bootstrap(together, fmt::format("{}", fmt::join(files, ", ")), bootstrap);
  SolveOptions options;
  options.threads = job.options.threads;
  const SolveReport report = Solve(together, start, options);
  LogInfo("{}", report.ToText());
  if (writes) WriteFileAtomically(job.run_folder / "solved.json", report.ToJson());
  if (const std::string doubt = report.Doubt(); !doubt.empty()) {
    ThrowComputation("the 3D poses to learn from cannot be believed: {}; then train on the result", doubt);
  }
  auto solved = together.sequences.begin();
  for (const std::size_t number : numbers) {
    for (Sequence& sequence : job.datasets[number].sequences) {
      sequence.solved_world = std::move(solved->solved_world);
      sequence.cameras = std::move((solved++)->cameras);
    }
    if (writes) WriteDataset(SolvedFile(job, number), job.datasets[number]);
  }
}

}  // namespace

TrainReport SolveThenTrain(TrainJob job) {
  // Minutes of work follow: first check the recordings, and that the folder may be written to.
  RequireRecordings(job);
  job.run_folder_lock = PrepareRunFolder(job.run_folder, job.resume, job.overwrite);
  std::vector<std::size_t> unsolved;
  for (std::size_t i = 0; i < job.datasets.size(); ++i) {
    if (!job.datasets[i].HasSolved()) unsolved.push_back(i);
  }
  const bool takes_solved = job.resume && !job.run_folder.empty();
  if (!unsolved.empty() && !(takes_solved && TakeSolved(job, unsolved))) SolveDatasets(job, unsolved);
  return Train(job);
}

}  // namespace canonpose
