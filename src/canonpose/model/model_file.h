// The model file (.cpm): everything needed to use a trained lifter, in one HDF5 file. No LibTorch in this header, so
// that a model can be read without it.
//
// clang-format off
//   /            attributes
//                  format = "canonpose-model", version = 1, 2 or 3
//                  program_version, width, preset, options (JSON), seed, steps,
//                  mirror_decision, mirror_slope, mirror_slope_error, perspective
//                from version 2 on: rotation, ray, focal
//                in version 3: network, confidences
//                in all versions, where the trap was looked for:
//                  trap_verdict, trap_depth_ratio, trap_angle_deg, trap_scatter_deg
//   /skeleton    as in a dataset file
//   /source      attributes format, layout, confidence_scale, mapping: the kind of keypoint file it was trained on;
//                morph: the morphing network that the keypoints went through before training, where there was one
//   /data        attributes files, fingerprints: what it was trained on
//   /morph       in version 3, where the lifter needs a morphing network: the network's own attributes, groups and
//                parameters, laid out like the file
//   /parameters  one float32 array per tensor
// clang-format on
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "canonpose/base/hdf5.h"
#include "canonpose/data/dataset.h"
#include "canonpose/model/model_form.h"
#include "canonpose/skeleton/skeleton.h"

namespace canonpose {

/// Named tensors as plain arrays; name -> values and shape.
using NamedArrays = std::map<std::string, h5::Array<float>>;

/// How the depth-reversal ambiguity was resolved: which of the two mirror images the network is (train/mirror.h).
struct MirrorDecision {
  /// "kept", "flipped", "undecided", "kept by request", "flipped by request", or "known from the truth", "... solution"
  /// or "... calibration" where poses were learned from those.
  std::string decision = "undecided";
  double slope = 0.0;        ///< perspective slope before the decision; negative for the right one
  double slope_error = 0.0;  ///< its standard error over clips
};

/// Whether training without labels has settled in a degenerate solution, the trap (train/trap.h).
struct TrapFinding {
  std::string verdict;       ///< "right", "suspicious" or "trapped"; empty where it was not looked for
  double depth_ratio = 0.0;  ///< depth of the poses over their width
  double angle_deg = 0.0;    ///< median angle between two views of a frame
  double scatter_deg = 0.0;  ///< median deviation of the relative rotation of two cameras from its mean; NaN if unknown
};

struct ModelFile;

struct ModelInfo {
  std::string program_version;
  Skeleton skeleton;
  DatasetSource source;
  NetworkKind network = NetworkKind::kCanonical;
  int width = 0;
  RotationForm rotation = RotationForm::kAxisAngle;
  InputForm input;
  std::string preset;
  std::string options;  ///< JSON of every training option
  std::uint64_t seed = 0;
  std::int64_t steps = 0;
  MirrorDecision mirror;
  TrapFinding trap;
  double perspective = 0.0;                    ///< learned perspective factor k; 0 without one
  std::vector<std::string> data_files;         ///< names without folders
  std::vector<std::string> data_fingerprints;  ///< hexadecimal, see Dataset::Fingerprint()
  /// The morphing network that 2D poses go through before this one; null without one.
  std::shared_ptr<const ModelFile> morph;
};

struct ModelFile {
  ModelInfo info;
  NamedArrays parameters;
};

/// Why the poses of a model cannot be believed, one sentence each: training ended in the trap, or could not decide the
/// mirror. Empty for most models.
std::vector<std::string> DoubtsAbout(const ModelInfo& info);

/// Writes atomically; the same model gives the same bits. The version is the first that can hold the model, so that
/// earlier programs can read it. Throws Error(kBadInput).
void WriteModelFile(const std::filesystem::path& path, const ModelFile& model);

/// `path` is a model file, or the folder of a training run that holds model.cpm. Throws Error(kBadInput).
ModelFile ReadModelFile(const std::filesystem::path& path);
/// The same for a model file in memory; errors call it `name`.
ModelFile ReadModelImage(std::string_view image, const std::string& name);
/// The same without the weights.
ModelInfo ReadModelInfo(const std::filesystem::path& path);

/// Whether `path` is a model file, or the folder of a training run that holds one.
bool IsModel(const std::filesystem::path& path);

// Shared with checkpoints.

void WriteModelInfo(h5::Group& root, const ModelInfo& info);
ModelInfo ReadModelInfo(const h5::Group& root);
void WriteArrays(h5::Group& group, const NamedArrays& arrays);
NamedArrays ReadArrays(const h5::Group& group);

}  // namespace canonpose
