// Questions to a child process, for libraries that crash, hang or take all memory on some damaged files: then only the
// child ends.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

namespace canonpose {

/// A copy of this process that answers questions until the object is destroyed.
///
/// It has the thread that made it and no other, so `answer` must not wait for another thread or for a lock that one may
/// hold: it may allocate memory, read files and call libraries that take no locks; not BLAS, OpenMP, CUDA or the log.
/// What it changes in memory stays in the child, and what it prints goes nowhere.
class ChildProcess {
 public:
  using Answer = std::function<std::string(std::string_view question)>;
  struct Limits {
    double cpu_seconds = 10.0;                        ///< for one answer
    std::size_t memory_bytes = std::size_t{1} << 30;  ///< beyond what this process has; no answer is longer

    /// Far more than a library needs for a sound file of this size, of which it makes `memory_per_byte` times as much.
    static Limits ForFile(const std::filesystem::path& path, std::size_t memory_per_byte);
  };

  /// Where the system has no child to give, questions are answered in this process.
  ChildProcess(Answer answer, const Limits& limits);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// The child's answer; nothing where it has ended, for this question or an earlier one. Throws the Error that
  /// `answer` throws.
  std::optional<std::string> Ask(std::string_view question);
  /// Why the child has ended: "crashes", "does not come to an end", "takes too much memory".
  [[nodiscard]] const std::string& why_ended() const { return why_ended_; }

 private:
  void End(bool is_memory);

  Answer answer_;
  Limits limits_;
  std::mutex mutex_;
  int socket_ = -1;
  int child_ = -1;
  bool has_child_ = false;
  std::string why_ended_;
};

}  // namespace canonpose
