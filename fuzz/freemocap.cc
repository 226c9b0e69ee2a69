// FreeMoCap's 2D array.
#include "detections.h"

CANONPOSE_FUZZ_TARGET(bytes) { canonpose::fuzz::ReadDetections("freemocap", canonpose::fuzz::Write("2d.npy", bytes)); }
