// Pose2Sim's and aniposelib's calibrations as TOML.
#include "fuzzing.h"

#include "canonpose/data/readers/calibration.h"

CANONPOSE_FUZZ_TARGET(bytes) { canonpose::ReadCalibration(canonpose::fuzz::Write("calibration.toml", bytes)); }
