// A pickle: every value in it, by all accessors.
#include "canonpose/data/codecs/pickle.h"

#include "fuzzing.h"

namespace {

using canonpose::fuzz::Try;
using canonpose::pickle::Value;

/// Visits a value and what it holds. A pickle may hold one value many times over; `left` bounds the visits.
void Visit(const Value& value, int* left) {
  if (--*left < 0) return;
  (void)value.Describe();
  Try([&] { (void)value.Unwrapped(); });
  Try([&] { (void)value.Text(); });
  Try([&] { (void)value.Integer(); });
  Try([&] { (void)value.Integers(); });
  Try([&] { (void)value.Shape(); });
  if (value.IsNumbers()) Try([&] { (void)value.ToNumbers(); });
  Try([&] {
    for (const std::string& key : value.Keys()) Visit(value[key], left);
  });
  Try([&] {
    for (std::size_t i = 0; i < value.size() && *left >= 0; ++i) Visit(value.At(i), left);
  });
}

}  // namespace

CANONPOSE_FUZZ_TARGET(bytes) {
  int left = 1000;
  Visit(canonpose::pickle::Decode(std::string(bytes), "a.pickle"), &left);
}
