// One array of NumPy, as numbers, as text and as a pickle.
#include "canonpose/data/codecs/npy.h"

#include "fuzzing.h"

CANONPOSE_FUZZ_TARGET(bytes) {
  const std::string array(bytes);
  canonpose::fuzz::Try([&] { canonpose::npy::ParsePickle(array, "a.npz", "a"); });
  canonpose::npy::Parse(array, "a.npz", "a");
}
