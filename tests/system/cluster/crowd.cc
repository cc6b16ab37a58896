#include "tests/system/cluster/crowd.h"

namespace arap::cluster {
namespace {

constexpr std::size_t kMostComplaints = 100;

}  // namespace

void Crowd::Stop() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  stopping_.notify_all();
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

std::vector<std::string> Crowd::Complaints() const {
  const std::lock_guard lock(mutex_);
  return complaints_;
}

bool Crowd::StopWithin(std::chrono::milliseconds period) {
  std::unique_lock lock(mutex_);
  return stopping_.wait_for(lock, period, [this] { return stop_; });
}

void Crowd::Complain(const std::string& sentence) {
  ++complaint_count_;
  const std::lock_guard lock(mutex_);
  if (complaints_.size() < kMostComplaints) complaints_.push_back(sentence);
}

}  // namespace arap::cluster
