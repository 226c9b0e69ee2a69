#include "canonpose/solve/serial_linear_algebra.h"

#include <dlfcn.h>

namespace canonpose {
namespace {

int Get(const char* function) {
  const auto get = reinterpret_cast<int (*)()>(dlsym(RTLD_DEFAULT, function));
  return get == nullptr ? -1 : get();
}

void Set(const char* function, int value) {
  if (const auto set = reinterpret_cast<void (*)(int)>(dlsym(RTLD_DEFAULT, function))) set(value);
}

}  // namespace

OneOpenMpThread::OneOpenMpThread() : active_levels_before_(Get("omp_get_max_active_levels")) {
  if (active_levels_before_ >= 0) Set("omp_set_max_active_levels", 0);
}

OneOpenMpThread::~OneOpenMpThread() {
  if (active_levels_before_ >= 0) Set("omp_set_max_active_levels", active_levels_before_);
}

OneBlasThread::OneBlasThread() : threads_before_(Get("openblas_get_num_threads")) {
  if (threads_before_ > 0) Set("openblas_set_num_threads", 1);
}

OneBlasThread::~OneBlasThread() {
  if (threads_before_ > 0) Set("openblas_set_num_threads", threads_before_);
}

}  // namespace canonpose
