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
  bool with_cameras = false;            ///< solved cameras are compared with calibrated ones, too
  bool canonical = false;               ///< canonical poses are compared with each other, too
  FrameErrors* frame_errors = nullptr;  ///< filled where it is given
};

/// Predicted poses of the T frames of one view; empty where there are none.
struct PredictedPoses {
  PoseSequence pose_in_camera;  ///< with the axes of the camera, from any origin, in any unit
  PoseSequence canonical;       ///< of a model
};

struct Predictor {
  /// Throws where a dataset does not suit.
  std::function<void(const Dataset& dataset, const std::string& file)> check;
  /// Called view by view, sequence by sequence.
  std::function<PredictedPoses(const Sequence& sequence, std::size_t camera)> predict;
  bool uses_calibration = false;  ///< of the datasets
  std::string mirror_advice{};    ///< EvaluationReport::mirror_advice
};

/// The stored poses of a solved dataset.
Predictor SolvedPoses();

/// What all calibrated cameras together give, to be compared with truth: no lifter of a single view with the same
/// keypoints does better.
Predictor TriangulatedPoses();

/// Truth and calibrations in centimetres or metres are read as such, which is reported. Throws Error(kBadInput) where a
/// file cannot be evaluated so, or holds none of the protocol's subjects or frames; and where truth or calibration
/// cannot be true: cameras are interchanged, truth is in another frame than the camera's, or a person has the size of
/// nobody (data/calibration_check.h, data/truth_frame.h).
EvaluationReport EvaluateDatasets(const DatasetEvaluation& job, const Predictor& predictor);

}  // namespace canonpose
