// The folder of a training run: keeping what is there from being lost.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace canonpose {

/// Makes the folder and removes what kills left half-written. Throws Error(kInvalidArgument) where it holds a run and
/// neither `resume` nor `overwrite` says what to do with it.
void PrepareRunFolder(const std::filesystem::path& folder, bool resume, bool overwrite);

/// Removes the lines of metrics.jsonl that lie after a checkpoint's step and those of restarts that were not finished
/// then: they will be written again.
void DropLaterMetrics(const std::filesystem::path& path, std::int64_t step, int restarts_finished);

/// Makes model.cpm of the checkpoint, where there is one, and says so: "the last good model, of step 7, is in ...". An
/// untrained network is no reason to replace a model that an earlier run left there. `other_parameters`: parameters of
/// the checkpoint that a model has not.
std::string KeepLastGoodModel(const std::filesystem::path& folder, const std::vector<std::string>& other_parameters);

}  // namespace canonpose
