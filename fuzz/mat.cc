// MATLAB's version 5: a cell array.
#include "fuzzing.h"

#include "canonpose/data/codecs/mat_file.h"

CANONPOSE_FUZZ_TARGET(bytes) {
  const canonpose::MatFile file(canonpose::fuzz::Write("annot.mat", bytes));
  for (const char* const name : {"annot2", "annot3", "univ_annot3"}) {
    canonpose::fuzz::Try([&] { (void)file.ReadCells(name, 14); });
  }
}
