#include "canonpose/model/runtime.h"

#include <filesystem>

#include <ATen/Context.h>
#include <ATen/Parallel.h>
#include <dlfcn.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"

namespace canonpose {

void RequireDevice(const std::string& device) {
  if (device != "cpu" && device != "cuda") ThrowUsage("--device: expected cpu or cuda, found {}", device);
  if (device == "cuda" && !at::hasCUDA()) {
    ThrowBadInput({"--device cuda", "", "a LibTorch with CUDA and an NVIDIA GPU", "none on this machine",
                   "leave the option out to use the CPU, or build against a LibTorch with CUDA"});
  }
}

std::string LinearAlgebraLibrary() {
  if (at::hasMKL()) return "MKL";
  // Which library answers LibTorch's calls is settled by the dynamic linker (on Debian by the alternative
  // libblas.so.3).
  const void* routine = dlsym(RTLD_DEFAULT, "sgemm_");
  Dl_info info{};
  if (routine == nullptr || dladdr(routine, &info) == 0 || info.dli_fname == nullptr) return "";
  std::error_code error;
  const std::filesystem::path path = std::filesystem::canonical(info.dli_fname, error);
  return error ? std::string(info.dli_fname) : path.string();
}

void WarnAboutSlowLinearAlgebra() {
  const std::string library = LinearAlgebraLibrary();
  if (library.empty() || library == "MKL") return;
  for (const char* fast : {"openblas", "mkl", "blis", "nvpl", "armpl"}) {
    if (library.find(fast) != std::string::npos) return;
  }
  LogWarning(
      "LibTorch multiplies matrices with {}, which is about 30 times slower than OpenBLAS; install it with: apt-get "
      "install "
      "libopenblas0-pthread",
      library);
}

void SetThreadCount(int threads) {
  if (threads <= 0) return;
  at::set_num_threads(threads);
  // OpenBLAS keeps threads of its own, which LibTorch does not know of.
  using SetThreads = void (*)(int);
  if (const auto set_threads = reinterpret_cast<SetThreads>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads")))
    set_threads(threads);
}

int ThreadCount() { return at::get_num_threads(); }

}  // namespace canonpose
