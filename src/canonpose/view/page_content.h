// What a page shows: the scenes of a file, and what else is known of them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "canonpose/analyse/analysis.h"
#include "canonpose/scene/scene.h"

namespace canonpose {

/// What one camera saw of one person, frame by frame in the camera's own time. Both are empty where nothing is known.
struct ViewKeypoints {
  std::vector<float> keypoints;   ///< (T, J, 2) pixels; NaN where not detected
  std::vector<float> confidence;  ///< (T, J) 0..1

  [[nodiscard]] bool empty() const { return keypoints.empty(); }
};

struct ShownScene {
  Scene scene;
  std::string capture;                                 ///< of a solved dataset, as its report names it
  std::vector<std::vector<ViewKeypoints>> detections;  ///< by person and camera; empty where the file has none
  std::vector<Analysis> analyses;                      ///< of the people; empty where they were not analysed
};

/// One file on the page.
struct ShownResult {
  std::string name;  ///< as the page calls it: the file's name without folders
  std::vector<ShownScene> scenes;
  std::string solve_report;  ///< SolveReport::ToJson(); may be empty
  std::string evaluation;    ///< ReportAsJson(); may be empty
};

/// Reads any file with scenes, with the keypoints of a solved dataset, and analyses the people. Throws
/// Error(kBadInput).
ShownResult ReadShownResult(const std::filesystem::path& path);

}  // namespace canonpose
