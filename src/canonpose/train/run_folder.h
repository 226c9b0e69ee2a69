// The folder of a training run, in which nothing good is lost; and runs without a folder.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "canonpose/base/folder_lock.h"
#include "canonpose/base/log.h"
#include "canonpose/train/checkpoint.h"

namespace canonpose {

/// Makes the folder, locks it for as long as the result lives, and removes half-written files that killed runs left.
/// Throws Error(kBadInput) where another run is being trained there, and Error(kInvalidArgument) where it holds a run
/// and neither `resume` nor `overwrite` says what to do with it. With an empty path nothing is done.
[[nodiscard]] std::shared_ptr<const FolderLock> PrepareRunFolder(const std::filesystem::path& folder, bool resume,
                                                                 bool overwrite);

/// What a run writes, and reads when it is resumed:
///
///   RUN/model.cpm       the model, written when training is done
///   RUN/checkpoint.h5   to resume from
///   RUN/metrics.jsonl   one line per epoch
///   RUN/train.log       the messages of the run
///   RUN/lock            while it is being trained (base/folder_lock.h)
///
/// With an empty path nothing is written, and there is nothing to resume.
class RunFolder {
 public:
  /// Prepares the folder, see above, unless `lock` says that it has been prepared.
  RunFolder(std::filesystem::path path, bool resume, bool overwrite, std::shared_ptr<const FolderLock> lock = nullptr);

  [[nodiscard]] bool exists() const { return !path_.empty(); }
  /// Its path, for messages.
  [[nodiscard]] std::string checkpoint_file() const { return (path_ / "checkpoint.h5").string(); }

  /// The checkpoint that the run continues from; nothing where it starts afresh.
  [[nodiscard]] std::optional<Checkpoint> ReadCheckpointToResume() const;
  void WriteCheckpoint(const Checkpoint& checkpoint) const;
  void WriteModel(const ModelFile& model) const;

  /// Removes metrics and log of an earlier run, unless this one continues it. Its model and checkpoint stay until this
  /// run replaces them by its own.
  void RemoveOldRecords() const;
  /// Removes the lines of metrics.jsonl that were written after a checkpoint, and those of restarts that were not
  /// finished then: they will be written again.
  void DropLaterMetrics(const Checkpoint& checkpoint) const;
  void AddMetrics(const std::string& line) const;

  /// From here on this thread's messages are written to train.log, too.
  void OpenLog();
  /// Writes to train.log only, if it is open.
  void WriteLog(const std::string& text);

  /// Makes model.cpm from the checkpoint, if there is one, and says so: "the last good model, of step 7, is in ...". An
  /// untrained network does not replace a model of an earlier run.
  [[nodiscard]] std::string KeepLastGoodModel() const;

 private:
  std::filesystem::path path_;
  std::shared_ptr<const FolderLock> lock_;
  bool resumes_ = false;
  std::unique_ptr<LogFile> log_;
};

}  // namespace canonpose
