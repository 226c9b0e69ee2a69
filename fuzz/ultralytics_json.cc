// Ultralytics' results as JSON.
#include "detections.h"

CANONPOSE_FUZZ_TARGET(bytes) {
  canonpose::fuzz::ReadDetections("ultralytics", canonpose::fuzz::Write("cam1.json", bytes));
}
