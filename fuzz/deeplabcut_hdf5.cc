// DeepLabCut's HDF5, as pandas writes it.
#include "detections.h"

CANONPOSE_FUZZ_TARGET(bytes) {
  canonpose::fuzz::ReadDetections("deeplabcut", canonpose::fuzz::Write("cam1.h5", bytes));
}
