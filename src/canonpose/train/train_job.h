// What a lifter is trained on, and where the result goes.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "canonpose/base/folder_lock.h"
#include "canonpose/data/dataset.h"
#include "canonpose/model/model_file.h"
#include "canonpose/train/options.h"

namespace canonpose {

struct TrainJob {
  std::vector<Dataset> datasets;
  std::vector<std::string> data_files;  ///< their names, for the record
  /// The morphing network that the datasets' 2D poses went through, for the record: the model will apply it to what it
  /// lifts. Null: none.
  std::shared_ptr<const ModelFile> morph;
  TrainOptions options;
  /// Where model, checkpoint, metrics and log are written (train/run_folder.h). Empty: nothing is written, the model is
  /// returned alone, and a run that is stopped is lost.
  std::filesystem::path run_folder;
  bool resume = false;     ///< continue from the folder's checkpoint where there is one
  bool overwrite = false;  ///< start afresh although the folder holds a run
  /// Of a caller who works in the run folder before Train() and has locked it (PrepareRunFolder()). Null: Train() does.
  std::shared_ptr<const FolderLock> run_folder_lock;
};

}  // namespace canonpose
