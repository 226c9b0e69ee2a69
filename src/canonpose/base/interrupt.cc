#include "canonpose/base/interrupt.h"

#include <csignal>

namespace canonpose {
namespace {

volatile std::sig_atomic_t received_signal = 0;

extern "C" void NoteSignal(int signal) { received_signal = signal; }

constexpr int kSignals[] = {SIGINT, SIGTERM};
struct sigaction previous_actions[2];

}  // namespace

InterruptGuard::InterruptGuard() {
  received_signal = 0;
  struct sigaction action {};
  action.sa_handler = NoteSignal;
  // One shot: the second signal meets the default, which ends the program.
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  for (int i = 0; i < 2; ++i) sigaction(kSignals[i], &action, &previous_actions[i]);
}

InterruptGuard::~InterruptGuard() {
  for (int i = 0; i < 2; ++i) sigaction(kSignals[i], &previous_actions[i], nullptr);
}

int InterruptGuard::signal() const { return received_signal; }

}  // namespace canonpose
