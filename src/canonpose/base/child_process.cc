#include "canonpose/base/child_process.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <new>
#include <utility>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include "canonpose/base/error.h"

namespace canonpose {
namespace {

/// What a message begins with: its kind and the length of the rest.
enum class Kind : std::uint32_t { kQuestion, kAnswer, kError, kNoMemory };
struct Head {
  Kind kind = Kind::kQuestion;
  ErrorKind error_kind = ErrorKind::kBadInput;
  std::uint64_t size = 0;
};

bool Send(int socket, const char* data, std::size_t size) {
  while (size > 0) {
    // Without a signal where nobody listens any more.
    const ssize_t sent = send(socket, data, size, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    data += sent;
    size -= static_cast<std::size_t>(sent);
  }
  return true;
}

bool Receive(int socket, char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t received = recv(socket, data, size, MSG_WAITALL);
    if (received < 0 && errno == EINTR) continue;
    if (received <= 0) return false;
    data += received;
    size -= static_cast<std::size_t>(received);
  }
  return true;
}

bool SendMessage(int socket, Head head, std::string_view text) {
  head.size = text.size();
  return Send(socket, reinterpret_cast<const char*>(&head), sizeof(head)) && Send(socket, text.data(), text.size());
}

bool ReceiveMessage(int socket, std::uint64_t longest, Head* head, std::string* text) {
  if (!Receive(socket, reinterpret_cast<char*>(head), sizeof(*head)) || head->size > longest) return false;
  text->resize(head->size);
  return Receive(socket, text->data(), text->size());
}

// ------------------------------------------------------------------------------------------------------ in the child

/// The address space of this process, in bytes.
rlim_t AddressSpace() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return static_cast<rlim_t>(pages) * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

/// Sets a limit of this process, as far as the limit that it was given allows.
void Limit(__rlimit_resource resource, rlim_t value) {
  rlimit limit{};
  getrlimit(resource, &limit);
  limit.rlim_cur = std::min(value, limit.rlim_max);
  setrlimit(resource, &limit);
}

double CpuSeconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

void Silence() {
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);  // NOLINT: the system's interface
  if (nowhere < 0) return;
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
}

bool AnswerOne(const ChildProcess::Answer& answer, std::string_view question, int socket) {
  Head head;
  std::string text;
  try {
    text = answer(question);
    head.kind = Kind::kAnswer;
  } catch (const Error& error) {
    head.kind = Kind::kError;
    head.error_kind = error.kind();
    text = error.what();
  } catch (const std::bad_alloc&) {
    head.kind = Kind::kNoMemory;
  }
  return SendMessage(socket, head, text);
}

/// In the child alone: the program's own handlers stay as they are.
void Handle(int number, sighandler_t handler) {
  struct sigaction action {};
  action.sa_handler = handler;
  sigaction(number, &action, nullptr);
}

/// The child's whole life.
[[noreturn]] void Live(const ChildProcess::Answer& answer, const ChildProcess::Limits& limits, rlim_t address_space,
                       int socket) noexcept {
  // Handlers of the program or of a debugging tool are for its own crashes. Here they are expected, and leave no core
  // dump.
  for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGXCPU}) Handle(signal, SIG_DFL);
  // A terminal sends these to both. What to do about them is the other process's business; this one ends with it.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) Handle(signal, SIG_IGN);
  Silence();
  Limit(RLIMIT_CORE, 0);
  Limit(RLIMIT_AS, address_space + limits.memory_bytes);
  Head head;
  std::string question;
  while (ReceiveMessage(socket, limits.memory_bytes, &head, &question)) {
    Limit(RLIMIT_CPU, static_cast<rlim_t>(std::ceil(CpuSeconds() + limits.cpu_seconds)));
    if (!AnswerOne(answer, question, socket)) break;
  }
  _exit(0);
}

}  // namespace

ChildProcess::Limits ChildProcess::Limits::ForFile(const std::filesystem::path& path, std::size_t memory_per_byte) {
  std::error_code error;
  std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (error) bytes = 0;
  constexpr double kBytesPerSecond = 10e6;
  Limits limits;
  limits.cpu_seconds = 1.0 + static_cast<double>(bytes) / kBytesPerSecond;
  limits.memory_bytes += memory_per_byte * bytes;
  return limits;
}

ChildProcess::ChildProcess(Answer answer, const Limits& limits) : answer_(std::move(answer)), limits_(limits) {
  int sockets[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets) != 0) return;
  const rlim_t address_space = AddressSpace();
  child_ = fork();
  if (child_ == 0) {
    close(sockets[0]);
    Live(answer_, limits_, address_space, sockets[1]);
  }
  close(sockets[1]);
  if (child_ < 0) {
    close(sockets[0]);
    return;
  }
  socket_ = sockets[0];
  has_child_ = true;
}

ChildProcess::~ChildProcess() {
  if (child_ <= 0) return;
  kill(child_, SIGKILL);
  End(false);
}

void ChildProcess::End(bool is_memory) {
  // A child that was made meanwhile has a copy of this end, which keeps closing it from being noticed.
  shutdown(socket_, SHUT_RDWR);
  close(socket_);
  int status = 0;
  while (waitpid(child_, &status, 0) < 0) {
    if (errno == EINTR) continue;
    status = 0;  // the program has asked the system to forget its children
    break;
  }
  child_ = -1;
  why_ended_ = "crashes";
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) why_ended_ = "does not come to an end";
  if (is_memory || (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL)) why_ended_ = "takes too much memory";
}

std::optional<std::string> ChildProcess::Ask(std::string_view question) {
  const std::lock_guard lock(mutex_);
  if (!has_child_) return answer_(question);
  if (child_ < 0) return std::nullopt;
  Head head;
  std::string text;
  const bool is_answered = SendMessage(socket_, {}, question) &&
                           ReceiveMessage(socket_, limits_.memory_bytes, &head, &text) && head.kind != Kind::kNoMemory;
  if (!is_answered) {
    End(head.kind == Kind::kNoMemory);
    return std::nullopt;
  }
  if (head.kind == Kind::kError) throw Error(head.error_kind, text);
  return text;
}

}  // namespace canonpose
