// A morphing network at work: 2D poses in, 2D poses out. No LibTorch in this header.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "canonpose/data/dataset.h"
#include "canonpose/model/model_file.h"

namespace canonpose {

class PoseMorph {
 public:
  /// Opens a model file, or the folder of a finished run, of `train-morph`. Throws Error(kBadInput), also where it is a
  /// lifter's.
  static PoseMorph Open(const std::filesystem::path& run_or_model, const std::string& device = "cpu");
  /// `file` is named where the model is damaged.
  static PoseMorph Of(std::shared_ptr<const ModelFile> model, const std::string& file,
                      const std::string& device = "cpu");
  ~PoseMorph();
  PoseMorph(PoseMorph&&) noexcept;
  PoseMorph& operator=(PoseMorph&&) noexcept;

  [[nodiscard]] const std::shared_ptr<const ModelFile>& model() const;

  /// Moves the detected joints of a view's T frames. Frames whose pose cannot be used (geometry/normalisation.h) and
  /// confidences stay as they are.
  void Apply(CameraView& view, int frame_count) const;
  /// All views. Throws Error(kBadInput) naming `file` where its joints are others.
  void Apply(Dataset& dataset, const std::string& file) const;

 private:
  struct State;
  explicit PoseMorph(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace canonpose
