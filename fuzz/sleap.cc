// SLEAP's analysis HDF5.
#include "detections.h"

CANONPOSE_FUZZ_TARGET(bytes) { canonpose::fuzz::ReadDetections("sleap", canonpose::fuzz::Write("cam1.h5", bytes)); }
