// An archive of NumPy arrays: all of its arrays, and poses to evaluate.
#include "canonpose/data/codecs/npz.h"

#include "fuzzing.h"

#include "canonpose/data/codecs/pickle.h"
#include "canonpose/evaluate/archives.h"

CANONPOSE_FUZZ_TARGET(bytes) {
  using canonpose::fuzz::Try;
  const std::filesystem::path path = canonpose::fuzz::Write("a.npz", bytes);
  Try([&] { canonpose::ReadPoseArchive(path); });
  const canonpose::NpzReader reader(path);
  for (const std::string& name : reader.names()) {
    Try([&] { (void)reader.Read(name); });
    Try([&] { (void)canonpose::pickle::Decode(reader.ReadPickle(name), "a.npz", name); });
  }
}
