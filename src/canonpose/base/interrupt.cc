#include "canonpose/base/interrupt.h"

#include <csignal>

namespace canonpose {
namespace {

volatile std::sig_atomic_t received_signal = 0;

extern "C" void NoteSignal(int signal) { received_signal = signal; }

void Install(int signal, bool guarded) {
  struct sigaction action {};
  action.sa_handler = guarded ? NoteSignal : SIG_DFL;
  // One shot: the second signal meets the default, which ends the program.
  action.sa_flags = guarded ? static_cast<int>(SA_RESETHAND) : 0;
  sigaction(signal, &action, nullptr);
}

}  // namespace

InterruptGuard::InterruptGuard() {
  received_signal = 0;
  Install(SIGINT, true);
  Install(SIGTERM, true);
}

InterruptGuard::~InterruptGuard() {
  Install(SIGINT, false);
  Install(SIGTERM, false);
}

int InterruptGuard::signal() const { return received_signal; }

}  // namespace canonpose
