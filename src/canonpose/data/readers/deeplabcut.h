// DeepLabCut: a table with a row per frame, as csv or as HDF5 (pandas), of one animal or of several.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "canonpose/data/readers/detections.h"

namespace canonpose {

/// The cameras of a path: a csv or h5 file, or a folder with one per camera. A camera has the video's name, which comes
/// before "DLC" in the file's name. Throws Error(kBadInput).
std::vector<CameraInput> FindDeepLabCutCameras(const std::filesystem::path& path);

/// Reads one camera. The header has a row each for the scorer, individuals (if there are several), body parts and
/// coordinates (x, y, and likelihood where a network wrote it: the confidence, otherwise 1). The layout is that of the
/// body parts; each individual is a track. Individuals with other body parts ("single") are left out, which is
/// reported. Frames have the row's number, or that in the name of the row's image. Throws Error(kBadInput).
DetectedCamera ReadDeepLabCut(const CameraInput& input);

/// Whether a file is one, by its first bytes.
bool IsDeepLabCutFile(const std::filesystem::path& file);

namespace deeplabcut {

/// A file's content, from csv or HDF5.
struct Table {
  std::vector<std::vector<std::string>> header;  ///< (columns) each: scorer, [individual], body part, coordinate
  std::vector<std::string> frames;               ///< (rows) a number, or the name of an image
  std::vector<std::string> places;               ///< (rows) for messages
  std::vector<double> values;                    ///< (rows, columns); NaN where missing
};

/// The table in an HDF5 file that pandas wrote, in either of its two forms. Throws Error(kBadInput).
Table ReadHdf5(const std::filesystem::path& path);

}  // namespace deeplabcut

}  // namespace canonpose
