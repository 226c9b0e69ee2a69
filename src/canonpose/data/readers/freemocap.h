// FreeMoCap's 2D array: the points of all cameras in one NumPy file.
#pragma once

#include <filesystem>
#include <vector>

#include "canonpose/data/readers/detections.h"

namespace canonpose {

/// The cameras of a path: the file (mediapipe2dData_numCams_numFrames_numTrackedPoints_pixelXY.npy), or the folder of a
/// recording session, or one that has the file in output_data/raw_data. Cameras are named by the videos in the
/// session's folder synchronized_videos, where there are as many, otherwise "camera0", "camera1", ... Throws
/// Error(kBadInput).
std::vector<CameraInput> FindFreemocapCameras(const std::filesystem::path& path);

/// Reads the camera that `input.part` counts, from 0, of (cameras, frames, points, 2 or 3). The third value is a
/// confidence where all of the camera are in 0..1; MediaPipe's depth, which is not, is not read. Of MediaPipe's 75 and
/// more points the 33 of the body are read, in the layout mediapipe-33; other numbers of points are recognised as for
/// other detectors. Points are pixels, or, in old files, fractions of the image. Throws Error(kBadInput).
DetectedCamera ReadFreemocap(const CameraInput& input);

/// Whether a file is a NumPy array of four dimensions, the last of which is 2 or 3.
bool IsFreemocapFile(const std::filesystem::path& file);

}  // namespace canonpose
