// 2D keypoints as detectors write them, so that other programs (and our own readers' tests) can take simulated ones.
#pragma once

#include <filesystem>

#include "canonpose/data/dataset.h"

namespace canonpose {

/// OpenPose's --write_json: `folder` with one file a frame, CAMERA_000000000000_keypoints.json. `view` holds keypoints
/// and confidence of `joint_count` joints in the detector's layout; a joint that is missing is 0, 0, 0, a frame without
/// any has no people. The folder appears whole or not at all. Throws Error(kBadInput) where it exists already or cannot
/// be written.
void WriteOpenPose(const std::filesystem::path& folder, const CameraView& view, int joint_count);

/// AlphaPose's default form: one list for all frames of a camera, images named 000000.jpg and so on. Frames without any
/// joint have no entry, but for the first and the last, so that the recording keeps its length. Throws
/// Error(kBadInput).
void WriteAlphaPose(const std::filesystem::path& file, const CameraView& view, int joint_count);

}  // namespace canonpose
