// Ultralytics' text files, a folder with one frame.
#include "detections.h"

CANONPOSE_FUZZ_TARGET(bytes) {
  canonpose::fuzz::Write("ultralytics/cam_1.txt", bytes);
  canonpose::fuzz::ReadDetections("ultralytics", canonpose::fuzz::Folder() / "ultralytics");
}
