// Calibrations as OpenCV's FileStorage writes them.
#include "fuzzing.h"

#include "canonpose/data/readers/calibration.h"

CANONPOSE_FUZZ_TARGET(bytes) { canonpose::ReadCalibration(canonpose::fuzz::Write("calibration.yml", bytes)); }
