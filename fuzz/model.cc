// A model, HDF5.
#include "fuzzing.h"

#include "canonpose/model/model_file.h"

CANONPOSE_FUZZ_TARGET(bytes) {
  const std::filesystem::path path = canonpose::fuzz::Write("model.cpm", bytes);
  if (canonpose::IsModel(path)) canonpose::ReadModelFile(path);
}
