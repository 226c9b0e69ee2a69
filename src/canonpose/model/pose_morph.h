// Applies a trained morphing network: 2D poses in, 2D poses out. No LibTorch in this header.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "canonpose/data/dataset.h"
#include "canonpose/model/model_file.h"

namespace canonpose {

class PoseMorph {
 public:
  /// Opens a model file or the folder of a finished run that `canonpose train-morph` made. Throws Error(kBadInput),
  /// also for a lifter's model.
  static PoseMorph Open(const std::filesystem::path& run_or_model, const std::string& device = "cpu");
  /// Errors name `file`.
  static PoseMorph Of(std::shared_ptr<const ModelFile> model, const std::string& file,
                      const std::string& device = "cpu");
  ~PoseMorph();
  PoseMorph(PoseMorph&&) noexcept;
  PoseMorph& operator=(PoseMorph&&) noexcept;

  [[nodiscard]] const std::shared_ptr<const ModelFile>& model() const;
  /// What DatasetSource::morph records: "the morphing network 0123456789abcdef of width 64".
  [[nodiscard]] std::string Describe() const;

  /// Moves the detected joints in the T frames of a view. Confidences stay as they are, and so do frames whose pose
  /// cannot be normalised (geometry/normalisation.h).
  void Apply(CameraView& view, int frame_count) const;
  /// Does that in all views, and records it in the dataset's source. Throws Error(kBadInput) naming `file` where its
  /// joints are not those of the network, or were moved by one before.
  void Apply(Dataset& dataset, const std::string& file) const;

 private:
  struct State;
  explicit PoseMorph(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace canonpose
