// The options of training a morphing network; one table of its fields (morph_options.cc) serves all that
// train/options.h names.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "canonpose/train/option_description.h"

namespace canonpose {

/// What each option means: DescribeMorphOptions() and docs/training-options.md.
struct MorphOptions {
  int epochs = 20;
  int width = 256;
  int batch_poses = 128;
  double learning_rate = 1e-3;
  double validation = 0.1;
  std::uint64_t seed = 0;

  // About the machine: a resumed run may change them.
  int threads = 0;
  std::string device = "cpu";
  double checkpoint_seconds = 30.0;

  /// Throws Error(kInvalidArgument) naming the first option that is out of range.
  void Validate() const;
  /// Those that change the result.
  [[nodiscard]] std::string ToJson() const;
  /// Throws Error(kInvalidArgument) for an unknown name (listing the known ones) or a value that does not parse.
  void Set(const std::string& name, const std::string& value);
};

/// All options in the order of the table.
const std::vector<OptionDescription>& DescribeMorphOptions();

}  // namespace canonpose
