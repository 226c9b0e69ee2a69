#include "canonpose/train/adam_update.h"

#include <cmath>

namespace canonpose {

template <typename T>
void UpdateParameters(std::int64_t count, const AdamConstants<T> k, const T* __restrict gradient, T* __restrict value,
                      T* __restrict first, T* __restrict second) {
  for (std::int64_t i = 0; i < count; ++i) {
    const T g = gradient[i] + k.decay * value[i];
    const T m = k.b1 * first[i] + k.c1 * g;
    const T v = k.b2 * second[i] + k.c2 * g * g;
    first[i] = m;
    second[i] = v;
    value[i] -= k.rate * m / (std::sqrt(v) * k.inverse_root + k.epsilon);
  }
}

template void UpdateParameters(std::int64_t, AdamConstants<float>, const float*, float*, float*, float*);
template void UpdateParameters(std::int64_t, AdamConstants<double>, const double*, double*, double*, double*);

}  // namespace canonpose
