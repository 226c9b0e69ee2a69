// MediaPipe's landmarks as csv.
#include "detections.h"

CANONPOSE_FUZZ_TARGET(bytes) {
  canonpose::fuzz::ReadDetections("mediapipe", canonpose::fuzz::Write("cam1.csv", bytes));
}
