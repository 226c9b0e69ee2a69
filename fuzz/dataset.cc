// A dataset, HDF5.
#include "canonpose/data/dataset.h"

#include "fuzzing.h"

CANONPOSE_FUZZ_TARGET(bytes) {
  const std::filesystem::path path = canonpose::fuzz::Write("data.h5", bytes);
  if (canonpose::IsDatasetFile(path)) canonpose::ReadDataset(path);
}
