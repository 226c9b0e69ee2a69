// Calibrations of Qualisys Track Manager.
#include "fuzzing.h"

#include "canonpose/data/readers/calibration.h"

CANONPOSE_FUZZ_TARGET(bytes) { canonpose::ReadCalibration(canonpose::fuzz::Write("calibration.qca.txt", bytes)); }
