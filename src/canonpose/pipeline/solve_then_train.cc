#include "canonpose/pipeline/solve_then_train.h"

#include <fmt/format.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/log.h"
#include "canonpose/pipeline/bootstrap.h"
#include "canonpose/solve/solver.h"
#include "canonpose/train/data_checks.h"
#include "canonpose/train/run_folder.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

Dataset SolvedDataset(const TrainJob& job, std::size_t number) {
  const Dataset& dataset = job.datasets[number];
  const fs::path file = job.run_folder / fmt::format("solved-{}.h5", number);
  const bool writes = !job.run_folder.empty();
  if (writes && job.resume && fs::exists(file)) {
    Dataset solved = ReadDataset(file);
    if (solved.Fingerprint() == dataset.Fingerprint()) return solved;
    LogInfo("{} was solved from other data: solving again", file.string());
  }
  BootstrapOptions bootstrap;
  bootstrap.kind = ToString(job.options.bootstrap);
  if (writes) bootstrap.run_folder = job.run_folder / fmt::format("bootstrap-{}", number);
  bootstrap.seed = job.options.seed;
  bootstrap.threads = job.options.threads;
  bootstrap.device = job.options.device;
  if (writes && !job.resume) fs::remove_all(bootstrap.run_folder);
  const StartPoses start = Bootstrap(dataset, job.data_files[number], bootstrap);
  SolveOptions options;
  options.threads = job.options.threads;
  Dataset solved = dataset;
  const SolveReport report = Solve(solved, start, options);
  LogInfo("{}", report.ToText());
  if (!writes) return solved;
  WriteFileAtomically(job.run_folder / fmt::format("solved-{}.json", number), report.ToJson());
  WriteDataset(file, solved);
  return solved;
}

}  // namespace

TrainReport SolveThenTrain(TrainJob job) {
  // Minutes of work follow: first check the recordings, and that the folder may be written to.
  RequireRecordings(job);
  PrepareRunFolder(job.run_folder, job.resume, job.overwrite);
  for (std::size_t i = 0; i < job.datasets.size(); ++i) {
    if (!job.datasets[i].HasSolved()) job.datasets[i] = SolvedDataset(job, i);
  }
  return Train(job);
}

}  // namespace canonpose
