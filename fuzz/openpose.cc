// OpenPose's JSON, a folder with one frame: reading, following a person, checking the layout.
#include "detections.h"

CANONPOSE_FUZZ_TARGET(bytes) {
  canonpose::fuzz::Write("openpose/cam_1_keypoints.json", bytes);
  canonpose::fuzz::ReadDetections("openpose", canonpose::fuzz::Folder() / "openpose");
}
