// An Acclaim motion of a skeleton that is as it should be.
#include "fuzzing.h"

#include "canonpose/motion/readers/acclaim.h"

CANONPOSE_FUZZ_TARGET(bytes) {
  static const bool copied = [] {
    std::filesystem::copy_file(CANONPOSE_TESTDATA "/mocap/tiny.asf", canonpose::fuzz::Folder() / "tiny.asf");
    return true;
  }();
  (void)copied;
  canonpose::ReadAcclaim(canonpose::fuzz::Write("tiny.amc", bytes));
}
