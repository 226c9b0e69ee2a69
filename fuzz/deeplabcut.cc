// DeepLabCut's csv.
#include "detections.h"

CANONPOSE_FUZZ_TARGET(bytes) {
  canonpose::fuzz::ReadDetections("deeplabcut", canonpose::fuzz::Write("cam1.csv", bytes));
}
