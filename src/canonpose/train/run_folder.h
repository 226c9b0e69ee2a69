// The folder of a training run: keeping what is there from being lost.
#pragma once

#include <cstdint>
#include <filesystem>

namespace canonpose {

/// Makes the folder and removes what kills left half-written. Throws Error(kUsage) where it holds a run and neither
/// `resume` nor `overwrite` says what to do with it.
void PrepareRunFolder(const std::filesystem::path& folder, bool resume, bool overwrite);

/// Removes the lines of metrics.jsonl that lie after a checkpoint's step and those of restarts that were not finished
/// then: they will be written again.
void DropLaterMetrics(const std::filesystem::path& path, std::int64_t step, int restarts_finished);

}  // namespace canonpose
