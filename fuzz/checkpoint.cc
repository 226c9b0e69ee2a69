// A checkpoint of a training run, HDF5.
#include "canonpose/train/checkpoint.h"

#include "fuzzing.h"

CANONPOSE_FUZZ_TARGET(bytes) {
  const std::filesystem::path path = canonpose::fuzz::Write("checkpoint.h5", bytes);
  if (canonpose::IsCheckpoint(path)) canonpose::ReadCheckpoint(path);
}
