#include "tests/attack/stage.h"

#include <csignal>
#include <fstream>
#include <memory>
#include <optional>
#include <vector>

#include <poll.h>

#include "tests/attack/bystander.h"
#include "tests/system/fault/server_process.h"
#include "tests/system/wire/token_fixture.h"

namespace arap::attack {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using std::chrono::steady_clock;

constexpr int kDrainSeconds = 3;
constexpr seconds kStopPatience{10};
constexpr seconds kSetUpPatience{10};
constexpr std::size_t kMegabyte = std::size_t{1} << 20u;

// The most memory that the process ever had resident.
std::size_t PeakBytes(const fault::ChildProcess& process) {
  std::ifstream status("/proc/" + std::to_string(process.pid()) + "/status");
  std::string word;
  std::size_t kilobytes = 0;
  while (status >> word) {
    if (word == "VmHWM:") status >> kilobytes;
  }
  return kilobytes * 1024;
}

class Stage {
 public:
  Stage(const Attack& attack, const StageOptions& options)
      : attack_(attack),
        options_(options),
        server_({"--token-file", secrets_.tokens(), "--drain-seconds",
                 std::to_string(kDrainSeconds), "--max-stream-load", "0.5", "--log-level", "warn",
                 "--access-log", "off", "--max-bytes",
                 std::to_string(attack.budget_megabytes * kMegabyte), "--max-bytes-per-owner",
                 std::to_string(attack.budget_megabytes * kMegabyte / 2),
                 "--max-cached-surface-bytes",
                 std::to_string(attack.budget_megabytes * kMegabyte / 4)}) {
    secrets_.PutTokens({bystander_token_.Entry(), attacker_token_.Entry()});
    server_.Under({"/usr/bin/prlimit", "--as=8589934592", "--nofile=1024:4096", "--core=0"});
    if (!options.server.empty()) server_.UseProgram(options.server);
    measured_.name = attack.name;
    measured_.budget_bytes = attack.budget_megabytes * kMegabyte;
    measured_.drain_seconds = kDrainSeconds;
  }

  Measured Run() {
    if (!Start()) return measured_;
    if (!Wait(options_.before)) return measured_;
    measured_.before = bystander_->Take();
    StartAttacker();
    if (Wait(options_.during)) {
      measured_.during = bystander_->Take();
      ReadSpent();
      Stop();
    }
    attacker_.Kill();
    bystander_.reset();
    return measured_;
  }

 private:
  bool Start() {
    measured_.ended = "it does not start";
    if (!server_.Start()) return false;
    const auto admin = server_.ReadLine("arapd admin on ", kSetUpPatience);
    if (!admin) return false;
    admin_ = *admin;
    bystander_ = std::make_unique<Bystander>(server_.address(), admin_, bystander_token_.Text());
    if (!bystander_->good()) return false;
    measured_.ended.clear();
    return true;
  }

  // The attacker has what the server and the bystander leave of the processor, and gives it up at once: what it computes
  // itself, on a machine of its own, would not disturb anybody.
  void StartAttacker() {
    if (!attacker_.Launch({"/usr/bin/chrt", "--idle", "0", options_.self, "--as-attacker",
                           attack_.name, server_.address(), admin_, attacker_token_.Text()},
                          server_.folder() / "attacker")) {
      return;
    }
    if (!attacker_.ReadLine("begins", kSetUpPatience)) measured_.spent = "NOT PREPARED";
    // What the preparation did to the bystander counts too, where it hurts memory; not its time.
    static_cast<void>(bystander_->Take());
  }

  // Looks at the memory meanwhile; false when the server ends.
  bool Wait(milliseconds time) {
    const auto end = steady_clock::now() + time;
    while (steady_clock::now() < end) {
      measured_.peak_bytes = std::max(measured_.peak_bytes, PeakBytes(server_));
      if (const auto code = server_.Wait(milliseconds(50))) {
        measured_.ended = "with code " + std::to_string(*code);
        if (bystander_) measured_.during = bystander_->Take();
        ReadSpent();
        return false;
      }
    }
    return true;
  }

  // The last line counts.
  void ReadSpent() {
    while (const auto line = attacker_.ReadLine("spent ", milliseconds(0))) {
      if (measured_.spent != "NOT PREPARED") measured_.spent = *line;
    }
  }

  // While the attack goes on.
  void Stop() {
    measured_.peak_bytes = std::max(measured_.peak_bytes, PeakBytes(server_));
    const auto start = steady_clock::now();
    server_.Signal(SIGTERM);
    const auto code = server_.Wait(kStopPatience);
    const std::chrono::duration<double> took = steady_clock::now() - start;
    if (!code) return server_.Kill();
    measured_.stopping = took.count();
    if (*code != 0) measured_.ended = "when told to, with code " + std::to_string(*code);
  }

  const Attack& attack_;
  const StageOptions& options_;
  const wire::SecretFolder secrets_;
  const wire::TestToken bystander_token_{'b', "bystander"};
  const wire::TestToken attacker_token_{'a', "mallory"};
  fault::ServerProcess server_;
  fault::ChildProcess attacker_;
  std::string admin_;
  std::unique_ptr<Bystander> bystander_;
  Measured measured_;
};

}  // namespace

Measured RunAttack(const Attack& attack, const StageOptions& options) {
  return Stage(attack, options).Run();
}

}  // namespace arap::attack
