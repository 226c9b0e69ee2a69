// A camera calibration as JSON.
#include "canonpose/data/readers/calibration.h"

#include "fuzzing.h"

CANONPOSE_FUZZ_TARGET(bytes) { canonpose::ReadCalibration(canonpose::fuzz::Write("calibration.json", bytes)); }
