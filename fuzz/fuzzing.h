// What the fuzz targets share: the bytes of a run as a file, and what a reader may do with them.
//
// A reader takes the bytes or throws an Error(kBadInput) of one line. Everything else ends the target, and libFuzzer
// keeps the bytes: a crash, any other exception, undefined behaviour, a hang, or more memory than run-fuzz allows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include "canonpose/base/callbacks.h"
#include "canonpose/base/error.h"

extern "C" void __sanitizer_set_death_callback(void (*callback)());

namespace canonpose::fuzz {

inline std::string_view Text(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// A folder of this process, in memory where the system has such a place.
inline const std::filesystem::path& Folder() {
  static const std::filesystem::path folder = [] {
    std::error_code error;
    const std::filesystem::path memory = "/dev/shm";
    const bool has_memory = std::filesystem::is_directory(memory, error) && access(memory.c_str(), W_OK) == 0;
    std::string name = ((has_memory ? memory : std::filesystem::temp_directory_path()) / "fuzz-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) std::abort();
    return std::filesystem::path(name);
  }();
  static const int remove_at_exit = std::atexit([] {
    std::error_code error;
    std::filesystem::remove_all(Folder(), error);
  });
  (void)remove_at_exit;
  return folder;
}

/// Writes a file in that folder; the name may have one folder of its own.
inline std::filesystem::path Write(const std::string& name, std::string_view bytes) {
  std::filesystem::path path = Folder() / name;
  std::filesystem::create_directories(path.parent_path());
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file.flush()) std::abort();
  return path;
}

/// A child of the target, in which the library tries a file, ends as it would outside the target: libFuzzer's handlers
/// would otherwise report every damaged file that it dies of.
inline void LetChildrenDie() {
  static const int registered = pthread_atfork(nullptr, nullptr, [] {
    __sanitizer_set_death_callback([] {});
    for (const int number : {SIGSEGV, SIGBUS, SIGABRT, SIGILL, SIGFPE, SIGXFSZ, SIGALRM, SIGTERM, SIGINT})
      signal(number, SIG_DFL);
  });
  (void)registered;
}

/// Calls a reader. Messages go nowhere.
template <typename Reader>
int Try(Reader&& read) {
  LetChildrenDie();
  Callbacks callbacks;
  callbacks.message = [](MessageLevel, const std::string&) {};
  const CallbackScope scope(callbacks);
  try {
    read();
  } catch (const Error& error) {
    const std::string_view message = error.what();
    if (error.kind() != ErrorKind::kBadInput || message.find('\n') != std::string_view::npos) {
      std::fprintf(stderr, "not one line about bad input: %s\n", error.what());
      std::abort();
    }
  }
  return 0;
}

}  // namespace canonpose::fuzz

/// Defines the target: `body` reads `bytes`, a std::string_view.
#define CANONPOSE_FUZZ_TARGET(bytes)                                                    \
  static void ReadBytes(std::string_view bytes);                                        \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {   \
    return canonpose::fuzz::Try([&] { ReadBytes(canonpose::fuzz::Text(data, size)); }); \
  }                                                                                     \
  static void ReadBytes(std::string_view bytes)
