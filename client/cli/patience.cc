#include "client/cli/patience.h"

#include <algorithm>
#include <cerrno>
#include <utility>

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "client/cli/terminal.h"

namespace arap::cli {
namespace {

using std::chrono::steady_clock;

// A signal handler has nothing else to speak to.
// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables)
std::atomic<bool> interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free);
// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables)
std::atomic<int> woken = -1;  // the eventfd of who waits

void Wake(int descriptor) {
  const int kept = errno;
  constexpr std::uint64_t kOnce = 1;
  // A full one wakes too.
  [[maybe_unused]] const auto written = write(descriptor, &kOnce, sizeof kOnce);
  errno = kept;
}

std::int64_t NanosNow() {
  return std::chrono::nanoseconds(steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Patience::Patience(std::chrono::milliseconds limit, std::function<void()> give_up, std::string what)
    : limit_(limit),
      give_up_(std::move(give_up)),
      what_(std::move(what)),
      heard_(NanosNow()),
      wake_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  interrupted = false;
  woken = wake_;
  struct sigaction note {};
  note.sa_handler = [](int) {
    interrupted = true;
    Wake(woken);
  };
  note.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
  sigemptyset(&note.sa_mask);
  sigaction(SIGINT, &note, &before_);
  watcher_ = std::thread([this] { Watch(); });
}

Patience::~Patience() {
  done_ = true;
  Wake(wake_);
  watcher_.join();
  sigaction(SIGINT, &before_, nullptr);
  if (wake_ >= 0) close(wake_);
}

void Patience::Heard() { heard_ = NanosNow(); }

void Patience::Watch() {
  using std::chrono::milliseconds;
  // Where nothing wakes, or the time that goes by is shown; and what poll takes.
  constexpr milliseconds kLook{100}, kMost{std::chrono::hours(1)};
  const auto start = steady_clock::now();
  StatusLine line(what_.empty());
  for (;;) {
    const milliseconds left = end_ == End::kNone
                                  ? std::chrono::ceil<milliseconds>(
                                        limit_ - std::chrono::nanoseconds(NanosNow() - heard_))
                                  : kMost;
    const bool looks = wake_ < 0 || !what_.empty();
    const milliseconds next = looks ? kLook : std::clamp(left, milliseconds(1), kMost);
    pollfd event{wake_, POLLIN, 0};
    if (poll(&event, 1, static_cast<int>(next.count())) > 0) {
      std::uint64_t rings = 0;
      [[maybe_unused]] const auto taken = read(wake_, &rings, sizeof rings);
    }
    if (done_) return;
    const auto passed =
        std::chrono::floor<std::chrono::seconds>(steady_clock::now() - start).count();
    if (passed >= 1) line.Show(fmt::format("{} {} s", what_, passed));
    const std::chrono::nanoseconds silent(NanosNow() - heard_);
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
