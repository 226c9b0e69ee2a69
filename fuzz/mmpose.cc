// Mmpose's JSON, one camera's predictions: reading, following a person, checking the layout.
#include "detections.h"

CANONPOSE_FUZZ_TARGET(bytes) {
  canonpose::fuzz::ReadDetections("mmpose", canonpose::fuzz::Write("frame_1.json", bytes));
}
