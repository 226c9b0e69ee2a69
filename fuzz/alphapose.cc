// AlphaPose's JSON, one camera's results: reading, following a person, checking the layout.
#include "detections.h"

CANONPOSE_FUZZ_TARGET(bytes) {
  canonpose::fuzz::ReadDetections("alphapose", canonpose::fuzz::Write("frame_1.json", bytes));
}
