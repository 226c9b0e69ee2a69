#include "canonpose/cli/interrupt.h"

#include <csignal>

namespace canonpose {
namespace {

volatile std::sig_atomic_t received_signal = 0;

extern "C" void NoteSignal(int signal) { received_signal = signal; }

constexpr std::array<int, 2> kSignals{SIGINT, SIGTERM};
/// How many objects live.
int depth = 0;

Callbacks CallbacksThatStop() {
  Callbacks callbacks = PassOn();
  callbacks.stop = [] { return received_signal != 0; };
  return callbacks;
}

}  // namespace

StopOnSignal::StopOnSignal() : scope_(CallbacksThatStop()) {
  if (depth++ == 0) received_signal = 0;
  struct sigaction action {};
  action.sa_handler = NoteSignal;
  // One shot: a second signal is handled by default, which ends the program.
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  for (std::size_t i = 0; i < previous_actions_.size(); ++i) {
    sigaction(kSignals[i], &action, &previous_actions_[i]);
  }
}

StopOnSignal::~StopOnSignal() {
  for (std::size_t i = 0; i < previous_actions_.size(); ++i) {
    sigaction(kSignals[i], &previous_actions_[i], nullptr);
  }
  --depth;
}

int StopOnSignal::exit_code() { return 128 + received_signal; }

}  // namespace canonpose
