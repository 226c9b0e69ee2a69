#include "canonpose/pipeline/evaluate_datasets.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/names.h"
#include "canonpose/base/progress.h"
#include "canonpose/data/calibration_check.h"
#include "canonpose/data/truth_frame.h"
#include "canonpose/evaluate/canonical.h"
#include "canonpose/evaluate/reference.h"
#include "canonpose/evaluate/selection.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

/// One evaluation over several files.
class Run {
 public:
  Run(const DatasetEvaluation& job, const Predictor& predictor) : job_(job), predictor_(predictor) {}

  void Add(const fs::path& file);
  EvaluationReport Finish();

 private:
  void Begin(const Skeleton& skeleton);
  void CheckFigures(Dataset& dataset, const std::string& file);
  void AddTruthKinds(const Dataset& dataset);
  void AddSequence(const Sequence& sequence, const SequencePoses& reference, const Selection& selection,
                   const std::string& prefix, Progress& progress);
  void AddCanonical(const std::vector<PoseSequence>& canonical, const std::vector<std::vector<PoseErrors>>& errors,
                    int frame_count);
  void ReportTruthKind(EvaluationReport& report) const;
  void ReportMissing(EvaluationReport& report) const;
  void ReportOtherBenchmarks(EvaluationReport& report) const;
  [[noreturn]] void ThrowNothingLeft() const;

  const DatasetEvaluation& job_;
  const Predictor& predictor_;
  Skeleton skeleton_;
  std::optional<Evaluation> evaluation_;
  std::optional<CanonicalSpread> canonical_;
  ReferenceSummary reference_;
  bool reference_is_doubtful_ = false;
  std::set<std::string> other_formats_;  ///< of data that are not the protocol's benchmark's
  std::set<std::string> truth_kinds_;    ///< "" if a sequence does not say
  CameraComparison cameras_;
  std::optional<WorldComparison> world_;
  std::int64_t left_out_sequences_ = 0;
  std::int64_t sequences_too_short_ = 0;
  std::vector<std::string> left_out_subjects_;
  std::set<std::string> subjects_;  ///< of the views that are compared
  std::int64_t views_ = 0;
  std::int64_t views_without_truth_ = 0;
  long views_done_ = 0;
};

void Run::Begin(const Skeleton& skeleton) {
  skeleton_ = skeleton;
  evaluation_.emplace(skeleton.joints, skeleton.root, job_.left_out, job_.protocol);
  evaluation_->KeepFrameErrors(job_.frame_errors);
  if (job_.canonical) canonical_.emplace(skeleton);
  std::vector<int> left_out;
  for (const std::string& joint : job_.left_out) {
    if (const std::optional<int> index = skeleton.Find(joint)) left_out.push_back(*index);
  }
  world_.emplace(std::move(left_out));
}

void Run::Add(const fs::path& file) {
  Dataset dataset = ReadDataset(file);
  if (job_.frames) KeepFrames(dataset, *job_.frames, file.string());
  const Selection selection = SelectPoses(dataset, job_.protocol, job_.frames ? job_.frames->first : 0);
  left_out_sequences_ += selection.left_out_sequences;
  sequences_too_short_ += selection.sequences_too_short;
  left_out_subjects_.insert(left_out_subjects_.end(), selection.left_out_subjects.begin(),
                            selection.left_out_subjects.end());
  if (dataset.sequences.empty()) return;
  predictor_.check(dataset, file.string());
  if (!evaluation_) Begin(dataset.skeleton);
  if (!skeleton_.SameJoints(dataset.skeleton)) {
    ThrowBadInput({file.string(), "/skeleton", "the joints of " + job_.files.front().string(), "others",
                   "evaluate files with different joints one by one"});
  }
  CheckFigures(dataset, file.string());
  const ReferencePoses reference(dataset, file.string());
  reference_.Add(reference);
  if (!reference.triangulated()) AddTruthKinds(dataset);
  if (job_.with_cameras) {
    cameras_.Add(dataset);
    world_->Add(dataset, reference.sequences());
  }
  const std::string prefix = job_.files.size() > 1 ? file.stem().string() + "/" : "";
  long view_count = 0;
  for (const Sequence& sequence : dataset.sequences) view_count += static_cast<long>(sequence.cameras.size());
  Progress progress("evaluate", view_count);
  views_done_ = 0;
  for (std::size_t s = 0; s < dataset.sequences.size(); ++s) {
    AddSequence(dataset.sequences[s], reference.sequences()[s], selection, prefix, progress);
  }
}

void Run::AddSequence(const Sequence& sequence, const SequencePoses& reference, const Selection& selection,
                      const std::string& prefix, Progress& progress) {
  const std::size_t row = 3 * skeleton_.joints.size();
  std::vector<PoseSequence> canonical;
  std::vector<std::vector<PoseErrors>> errors;
  for (std::size_t c = 0; c < sequence.cameras.size(); ++c) {
    const std::string& camera = sequence.cameras[c].name;
    progress.Update(views_done_++, fmt::format("{} {}", sequence.name, camera));
    const std::vector<float>& truth = reference.poses_in_camera[c].positions();
    ++views_;
    if (truth.empty()) {
      ++views_without_truth_;
      continue;
    }
    subjects_.insert(sequence.subject);
    PredictedPoses predicted = predictor_.predict(sequence, c);
    if (predicted.pose_in_camera.empty()) predicted.pose_in_camera = PoseSequence(skeleton_, sequence.frame_count);
    const std::vector<float>& prediction = predicted.pose_in_camera.positions();
    CANONPOSE_CHECK(prediction.size() == truth.size() && truth.size() % row == 0, "{} and {} values", prediction.size(),
                    truth.size());
    errors.emplace_back();
    for (std::size_t t = 0; t * row < truth.size(); ++t) {
      const PoseSource source{prefix + sequence.name, camera, selection.FrameNumber(t), ActionIn(sequence, t)};
      errors.back().push_back(evaluation_->Add(source, &prediction[t * row], &truth[t * row]));
    }
    canonical.push_back(std::move(predicted.canonical));
  }
  if (canonical_) AddCanonical(canonical, errors, sequence.frame_count);
}

void Run::AddCanonical(const std::vector<PoseSequence>& canonical, const std::vector<std::vector<PoseErrors>>& errors,
                       int frame_count) {
  const std::size_t row = 3 * skeleton_.joints.size();
  for (std::size_t t = 0; t < static_cast<std::size_t>(frame_count); ++t) {
    for (std::size_t c = 0; c < canonical.size(); ++c)
      canonical_->AddView(&canonical[c].positions()[t * row], errors[c][t]);
    canonical_->EndFrame();
  }
}

/// What is compared with must be possible.
void Run::CheckFigures(Dataset& dataset, const std::string& file) {
  const Protocol& protocol = job_.protocol;
  const std::string& format = dataset.source.format;
  if (!protocol.formats.empty() && !format.empty() && std::ranges::count(protocol.formats, format) == 0) {
    other_formats_.insert(format);
  }
  if (dataset.HasTruth()) {
    CheckUnitOfTruth(dataset, file);
    RequireTruthInCameraFrame(dataset, file);
  }
  const bool is_reference = !dataset.HasTruth();
  const bool uses_calibration = is_reference || predictor_.uses_calibration || job_.with_cameras;
  if (!uses_calibration || !dataset.HasCalibration() || CheckCalibration(dataset, file)) return;
  reference_is_doubtful_ = reference_is_doubtful_ || is_reference || predictor_.uses_calibration;
}

void Run::AddTruthKinds(const Dataset& dataset) {
  for (const Sequence& sequence : dataset.sequences) {
    const bool has_truth = std::any_of(sequence.cameras.begin(), sequence.cameras.end(),
                                       [](const CameraView& view) { return !view.truth.empty(); });
    if (has_truth) truth_kinds_.insert(sequence.truth_kind);
  }
}

void Run::ReportTruthKind(EvaluationReport& report) const {
  std::vector<std::string> kinds(truth_kinds_.begin(), truth_kinds_.end());
  std::replace(kinds.begin(), kinds.end(), std::string(), std::string("unknown"));
  if (truth_kinds_ != std::set<std::string>{""}) report.truth_kind = fmt::format("{}", fmt::join(kinds, " and "));
  const std::string& wanted = job_.protocol.truth_kind;
  if (wanted.empty() || truth_kinds_ == std::set<std::string>{wanted}) return;
  report.warnings.push_back(fmt::format("{} compares with truth of the kind {}, but {}", job_.protocol.name, wanted,
                                        report.truth_kind.empty() ? "the data do not say which theirs is"
                                                                  : fmt::format("this is {}", report.truth_kind)));
}

void Run::ReportMissing(EvaluationReport& report) const {
  std::vector<std::string> missing;
  for (const std::string& wanted : job_.protocol.subjects) {
    if (std::none_of(subjects_.begin(), subjects_.end(), [&](const std::string& s) { return SameName(s, wanted); })) {
      missing.push_back(wanted);
    }
  }
  if (!missing.empty()) {
    report.warnings.push_back(fmt::format("{} evaluates {}, but the data have no truth of {}", job_.protocol.name,
                                          fmt::join(job_.protocol.subjects, " and "), fmt::join(missing, " and ")));
  }
  if (views_without_truth_ > 0) {
    report.warnings.push_back(
        fmt::format("{} of {} views have no truth and are left out", views_without_truth_, views_));
  }
}

void Run::ReportOtherBenchmarks(EvaluationReport& report) const {
  if (other_formats_.empty()) return;
  report.warnings.push_back(
      fmt::format("{} is the protocol of {}, but these data are of the format {}: do not compare the "
                  "figures with published ones",
                  job_.protocol.name, job_.protocol.benchmark, fmt::join(other_formats_, " and ")));
}

void Run::ThrowNothingLeft() const {
  const Protocol& protocol = job_.protocol;
  const std::string file = job_.files.front().string();
  if (sequences_too_short_ > 0) {
    ThrowBadInput({file, "", fmt::format("{}, as {} evaluates", PosesInWords(protocol), protocol.name), "none of them",
                   "choose `frames` that hold some"});
  }
  std::vector<std::string> subjects = left_out_subjects_;
  std::sort(subjects.begin(), subjects.end());
  subjects.erase(std::unique(subjects.begin(), subjects.end()), subjects.end());
  ThrowBadInput({file, "",
                 fmt::format("subjects {}, whom {} evaluates", fmt::join(protocol.subjects, " and "), protocol.name),
                 subjects.empty() ? "no sequences" : fmt::format("{}", fmt::join(subjects, ", ")),
                 fmt::format("give the data of these subjects, or `protocol={}`", kAllFrames)});
}

EvaluationReport Run::Finish() {
  if (!evaluation_) ThrowNothingLeft();
  EvaluationReport report = evaluation_->Finish(reference_.Kind(), job_.files.front().string());
  ReportTruthKind(report);
  ReportMissing(report);
  ReportOtherBenchmarks(report);
  report.reference_is_doubtful = reference_is_doubtful_;
  report.mirror_advice = predictor_.mirror_advice;
  report.left_out_sequences = left_out_sequences_;
  report.cameras = cameras_.Medians();
  report.world = world_->Means();
  if (canonical_) report.canonical = canonical_->Finish();
  if (canonical_ && !report.canonical) {
    report.warnings.emplace_back(
        "canonical poses are not compared: every pose points away from its truth, so that none has a size");
  }
  return report;
}

}  // namespace

Predictor SolvedPoses() {
  return {[](const Dataset& dataset, const std::string& file) {
            if (dataset.HasSolved()) return;
            ThrowBadInput({file, "", "solved poses, since no model was given", "none",
                           "name a model before the data, or give `triangulate`"});
          },
          [](const Sequence& sequence, std::size_t camera) {
            return PredictedPoses{sequence.cameras[camera].solved, {}};
          },
          false, "solve again with `mirror=flip`, or with `mirror=keep` if its report says that it was flipped"};
}

Predictor TriangulatedPoses() {
  struct Cache {
    Skeleton skeleton;
    const Sequence* sequence = nullptr;
    SequencePoses poses;
  };
  const auto cache = std::make_shared<Cache>();
  return {[cache](const Dataset& dataset, const std::string& file) {
            *cache = {dataset.skeleton, nullptr, {}};
            if (!dataset.HasTruth()) {
              ThrowBadInput({file, "", "truth to compare the triangulation with", "none", "evaluate data with truth"});
            }
            if (!dataset.HasCalibration()) {
              ThrowBadInput(
                  {file, "", "calibrated cameras to triangulate from", "none", "import the data with `calibration`"});
            }
          },
          [cache](const Sequence& sequence, std::size_t camera) {
            if (cache->sequence != &sequence) {
              cache->sequence = &sequence;
              cache->poses = TriangulateSequence(sequence, cache->skeleton);
            }
            return PredictedPoses{cache->poses.poses_in_camera[camera], {}};
          },
          /*uses_calibration=*/true};
}

EvaluationReport EvaluateDatasets(const DatasetEvaluation& job, const Predictor& predictor) {
  Run run(job, predictor);
  for (const fs::path& file : job.files) run.Add(file);
  return run.Finish();
}

}  // namespace canonpose
