#include "client/cli/interrupt.h"

#include <atomic>

namespace arap::cli {
namespace {

// A signal handler has nothing else to speak to.
std::atomic<bool> interrupted =
    false;  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables)
static_assert(std::atomic<bool>::is_always_lock_free);

void Note(int) { interrupted = true; }

}  // namespace

Interrupt::Interrupt() {
  interrupted = false;
  struct sigaction note {};
  note.sa_handler = &Note;
  note.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
  sigemptyset(&note.sa_mask);
  sigaction(SIGINT, &note, &before_);
}

Interrupt::~Interrupt() { sigaction(SIGINT, &before_, nullptr); }

bool Interrupt::happened() const { return interrupted; }

}  // namespace arap::cli
