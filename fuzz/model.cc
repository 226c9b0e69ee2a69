// A model, HDF5.
#include "canonpose/model/model_file.h"

#include "fuzzing.h"

CANONPOSE_FUZZ_TARGET(bytes) {
  const std::filesystem::path path = canonpose::fuzz::Write("model.cpm", bytes);
  if (canonpose::IsModel(path)) canonpose::ReadModelFile(path);
}
