// The loop of Adam over the elements of a parameter. It does not include LibTorch, because it is compiled with options
// of its own.
#pragma once

#include <cstdint>

namespace canonpose {

/// The constants of step t in the parameters' own type. They are passed by value and prepared outside the loop, so that
/// the compiler knows they do not change and vectorises; with -fno-math-errno it vectorises the square root too.
template <typename T>
struct AdamConstants {
  T rate;          ///< learning rate / (1 - b1^t)
  T inverse_root;  ///< 1 / sqrt(1 - b2^t)
  T decay;
  T b1;
  T b2;
  T c1;  ///< 1 - b1
  T c2;  ///< 1 - b2
  T epsilon;
};

/// One step for `count` elements, T being float or double: m = b1 m + c1 g, v = b2 v + c2 g^2 with g = gradient + decay
/// * value, and value -= rate * m / (inverse_root * sqrt(v) + epsilon) (Kingma and Ba, ICLR 2015, with weight decay in
/// the gradient).
template <typename T>
void UpdateParameters(std::int64_t count, AdamConstants<T> constants, const T* gradient, T* value, T* first_moment,
                      T* second_moment);

}  // namespace canonpose
