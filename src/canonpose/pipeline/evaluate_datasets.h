// What `evaluate` does with datasets: reads them, takes what the protocol evaluates, has its poses predicted, compares.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "canonpose/data/dataset.h"
#include "canonpose/evaluate/evaluation.h"

namespace canonpose {

struct DatasetEvaluation {
  std::vector<std::filesystem::path> files;  ///< datasets of the same joints
  Protocol protocol;
  std::optional<FrameRange> frames;
  std::vector<std::string> left_out;    ///< joints by name
  bool with_cameras = false;            ///< also compare solved cameras with calibrated ones, and places in the world
  bool canonical = false;               ///< also compare canonical poses with each other
  FrameErrors* frame_errors = nullptr;  ///< filled if it is not null
};

/// Predicted poses of the T frames of one view; empty where there are none.
struct PredictedPoses {
  PoseSequence pose_in_camera;  ///< with the axes of the camera, from any origin, in any unit
  PoseSequence canonical;       ///< of a model
};

struct Predictor {
  /// Throws if a dataset lacks something that the poses are made from.
  std::function<void(const Dataset& dataset, const std::string& file)> check;
  /// Called view by view, sequence by sequence.
  std::function<PredictedPoses(const Sequence& sequence, std::size_t camera)> predict;
  bool uses_calibration = false;  ///< of the datasets
  std::string mirror_advice{};    ///< EvaluationReport::mirror_advice
};

/// The stored poses of a solved dataset.
Predictor SolvedPoses();

/// Poses triangulated from all calibrated cameras together, to be compared with truth: a bound for lifters that see a
/// single view of the same keypoints.
Predictor TriangulatedPoses();

/// Truth and calibrations in centimetres or metres are read as such, which is reported. Throws Error(kBadInput) where a
/// file cannot be evaluated so, or holds none of the protocol's subjects or frames; and where truth or calibration
/// cannot be true: cameras are interchanged, truth is in another frame than the camera's, or a person has the size of
/// nobody (data/calibration_check.h, data/truth_frame.h).
EvaluationReport EvaluateDatasets(const DatasetEvaluation& job, const Predictor& predictor);

}  // namespace canonpose
