#include "canonpose/cli/interrupt.h"

#include <csignal>

namespace canonpose {
namespace {

volatile std::sig_atomic_t received_signal = 0;

extern "C" void NoteSignal(int signal) { received_signal = signal; }

constexpr int kSignals[] = {SIGINT, SIGTERM};
struct sigaction previous_actions[2];

Callbacks CallbacksThatStop() {
  Callbacks callbacks = PassOn();
  callbacks.stop = [] { return received_signal != 0; };
  return callbacks;
}

}  // namespace

StopOnSignal::StopOnSignal() : scope_(CallbacksThatStop()) {
  received_signal = 0;
  struct sigaction action {};
  action.sa_handler = NoteSignal;
  // One shot: a second signal is handled by default, which ends the program.
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  for (int i = 0; i < 2; ++i) sigaction(kSignals[i], &action, &previous_actions[i]);
}

StopOnSignal::~StopOnSignal() {
  for (int i = 0; i < 2; ++i) sigaction(kSignals[i], &previous_actions[i], nullptr);
}

int StopOnSignal::exit_code() { return 128 + received_signal; }

}  // namespace canonpose
