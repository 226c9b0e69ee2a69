#include "canonpose/model/runtime.h"

#include <string>
#include <vector>

#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <link.h>

namespace canonpose {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

/// The library that a call of this routine goes to.
std::string LibraryOf(const char* routine) {
  Dl_info info{};
  const void* address = dlsym(RTLD_DEFAULT, routine);
  return address == nullptr || dladdr(address, &info) == 0 ? "nothing" : info.dli_fname;
}

std::vector<std::string> LoadedLibraries() {
  std::vector<std::string> names;
  dl_iterate_phdr(
      [](dl_phdr_info* info, std::size_t, void* list) {
        static_cast<std::vector<std::string>*>(list)->emplace_back(info->dlpi_name);
        return 0;
      },
      &names);
  return names;
}

// This program is linked as all of ours are.
TEST(Runtime, EveryCallOfLinearAlgebraGoesToOpenBlas) {
  if (LinearAlgebraLibrary() == "MKL") GTEST_SKIP() << "this LibTorch brings MKL";
  EXPECT_THAT(LinearAlgebraLibrary(), HasSubstr("openblas"));
  for (const char* routine : {"sgemm_", "dgemm_", "sgemv_", "sdot_", "dsyrk_", "dtrsm_", "dpotrf_", "dgesdd_"}) {
    EXPECT_THAT(LibraryOf(routine), HasSubstr("openblas")) << routine;
  }
}

TEST(Runtime, LoadsNoSlowLibrary) {
  EXPECT_THAT(LoadedLibraries(), Not(Contains(HasSubstr("atlas"))));
  EXPECT_THAT(LoadedLibraries(), Not(Contains(HasSubstr("f77blas"))));
}

TEST(Runtime, AThreadScopeRestoresTheNumberOfThreads) {
  const int before = ThreadCount();
  {
    const ThreadScope two(2);
    EXPECT_EQ(ThreadCount(), 2);
    {
      const ThreadScope one(0);
      EXPECT_EQ(ThreadCount(), 1);
    }
    EXPECT_EQ(ThreadCount(), 2);
  }
  EXPECT_EQ(ThreadCount(), before);
}

TEST(Runtime, MultipliesAboutAsFastAsOpenBlasAlone) {
  if (LinearAlgebraLibrary() == "MKL") GTEST_SKIP() << "this LibTorch brings MKL";
  const LinearAlgebraSpeed speed = MeasureLinearAlgebra();
  ASSERT_GT(speed.openblas_gflops, 0.0);
  EXPECT_GT(speed.gflops, speed.openblas_gflops / 3.0) << "OpenBLAS alone: " << speed.openblas_gflops;
}

}  // namespace
}  // namespace canonpose
