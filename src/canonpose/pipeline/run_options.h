// The options of a whole run, from videos to a page and a model: which of its commands takes which.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "canonpose/pipeline/recording_inputs.h"
#include "canonpose/pipeline/step_command.h"

namespace canonpose {

/// An option that a run passes on to one of its commands. To offer one more, add a row to the table in run_options.cc:
/// the command line takes its help and its form from the command that it belongs to.
struct RunOption {
  enum class For {
    kBoth,
    kVideos,
    kKeypoints,
  };
  std::string_view command;  ///< "import"
  std::string_view field;    ///< "image_size"; an option of several commands has a row for each
  For inputs = For::kBoth;   ///< of which inputs it can be given; of others the command does not get it
  bool has_effect = true;    ///< on the result; false for those about speed
  bool may_be_path = false;  ///< a value that names a file or folder is one
};

const std::vector<RunOption>& RunOptionTable();

struct RunOptions {
  std::vector<std::string> inputs;  ///< videos, folders of videos, or keypoints (FindRecording())
  std::string format;               ///< of keypoints; empty: recognised by their content
  std::filesystem::path output;     ///< a new or empty folder, or that of an earlier run
  bool trains = true;
  std::vector<std::string> formats{"csv", "trc", "c3d", "bvh"};  ///< of exports: extensions of SceneFormats()
  bool formats_are_chosen = false;  ///< by the user: one that cannot be written is an error then
  /// Options of commands by field, in the order given; an option that is only there or not has an empty value.
  std::vector<std::pair<std::string, std::string>> fields;

  /// Throws Error(kInvalidArgument) where values are none, or options have no meaning with each other. Training options
  /// are for the caller to check (StepHooks::check).
  void Validate() const;

  /// The values of one field.
  [[nodiscard]] std::vector<std::string> Get(const std::string& field) const;
  [[nodiscard]] bool Has(const std::string& field) const { return !Get(field).empty(); }
};

/// Throws Error(kInvalidArgument) for options that mean nothing for these inputs.
void RequireOptionsFor(const RunOptions& options, const RecordingInputs& inputs);

/// Adds the options of a command to it.
void AddFields(const RunOptions& options, const RecordingInputs& inputs, StepCommand& command);

/// The fields of a command that have no effect on its result.
std::vector<std::string> FieldsWithoutEffect(std::string_view command);

}  // namespace canonpose
