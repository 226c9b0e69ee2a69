// docs/training-options.md: every preset and option of training, from their tables.
#pragma once

#include <string>

namespace canonpose {

/// The whole document, in Markdown. options_test compares the file with it, and writes the file when
/// CANONPOSE_WRITE_DOCS is set in the environment.
std::string TrainingOptionsDocument();

}  // namespace canonpose
