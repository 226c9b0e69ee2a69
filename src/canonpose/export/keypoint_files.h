// Writes 2D keypoints in detectors' formats, so that other programs (and tests of our own readers) can use simulated
// keypoints.
#pragma once

#include <filesystem>

#include "canonpose/data/dataset.h"

namespace canonpose {

/// The format of OpenPose's option write_json: `folder` with one file per frame, CAMERA_000000000000_keypoints.json.
/// `view` has keypoints and confidences of `joint_count` joints in the detector's layout. A missing joint is written as
/// 0, 0, 0; a frame without joints has no people. The folder appears whole or not at all. Throws Error(kBadInput) where
/// it already exists or cannot be written.
void WriteOpenPose(const std::filesystem::path& folder, const CameraView& view, int joint_count);

/// AlphaPose's default format: one list for all frames of a camera, with images named 000000.jpg and so on. Frames
/// without joints have no entry, except for the first and the last, so that the recording keeps its length. Throws
/// Error(kBadInput).
void WriteAlphaPose(const std::filesystem::path& file, const CameraView& view, int joint_count);

}  // namespace canonpose
