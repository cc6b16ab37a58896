#include "client/cli/patience.h"

#include <utility>

#include <fmt/format.h>

#include "client/cli/terminal.h"

namespace arap::cli {
namespace {

using std::chrono::steady_clock;

// A signal handler has nothing else to speak to.
// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables)
std::atomic<bool> interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free);

std::int64_t Now() {
  return std::chrono::nanoseconds(steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Patience::Patience(std::chrono::milliseconds limit, std::function<void()> give_up, std::string what)
    : limit_(limit), give_up_(std::move(give_up)), what_(std::move(what)), heard_(Now()) {
  interrupted = false;
  struct sigaction note {};
  note.sa_handler = [](int) { interrupted = true; };
  note.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
  sigemptyset(&note.sa_mask);
  sigaction(SIGINT, &note, &before_);
  watcher_ = std::thread([this] { Watch(); });
}

Patience::~Patience() {
  {
    const MutexLock lock(&mutex_);
    done_ = true;
    wake_.Signal();
  }
  watcher_.join();
  sigaction(SIGINT, &before_, nullptr);
}

void Patience::Heard() { heard_ = Now(); }

void Patience::Watch() {
  constexpr std::chrono::milliseconds kLook{100};
  const auto start = steady_clock::now();
  StatusLine line(what_.empty());
  for (;;) {
    {
      const MutexLock lock(&mutex_);
      const auto next = steady_clock::now() + kLook;
      while (!done_ && !wake_.WaitUntil(&mutex_, next)) {
      }
      if (done_) return;
    }
    const auto passed =
        std::chrono::floor<std::chrono::seconds>(steady_clock::now() - start).count();
    if (passed >= 1) line.Show(fmt::format("{} {} s", what_, passed));
    const std::chrono::nanoseconds silent(Now() - heard_);
    if (end_ != End::kNone || !(interrupted || silent > limit_)) continue;
    end_ = interrupted ? End::kInterrupted : End::kSilent;
    give_up_();
  }
}

Fault Patience::Explain(Fault fault) const {
  switch (end_) {
    case End::kNone:
      return fault;
    case End::kInterrupted:
      return Fault(FaultKind::kCancelled, "Interrupted.");
    case End::kSilent:
      return Fault(
          FaultKind::kDeadlineExceeded,
          fmt::format("The server has sent nothing new for {} s; --timeout is how long to wait.",
                      std::chrono::duration<double>(limit_).count()));
  }
  return fault;
}

}  // namespace arap::cli
