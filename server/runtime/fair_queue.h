// FairQueue: what waits for a worker, and whose turn it is. Owners share a lane in equal parts of
// its time, and so do the streams of one owner.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "core/base/names.h"

namespace arap::runtime {

// Whose work it is, and what it is expected to take.
struct Share {
  std::string owner;
  std::uint64_t flow = 0;  // of the owner: a stream has one of its own, all calls have 0
  double seconds = 0;
};

// Not thread-safe; the time comes with the entries.
//   - Next comes the owner that was served least, of its flows the one that was served least, of
//     the flow's entries the oldest, where an entry is taken for younger by kPatience times what it
//     is expected to take. So short work goes before long work, and long work gets its turn.
//   - Served counts in seconds: what was expected when work is taken, at most kSlice of it, and the
//     rest when it is known (Charge).
//   - Who comes back after a pause counts as served as much as the one whose turn it is, so that
//     nobody saves up turns; and at most kMostDebt more, so that what somebody took when nobody
//     else wanted it is soon forgotten.
// Push, Pop and Charge take O(log n), and Pop of short work and PopWhere O(n).
template <class T>
class FairQueue {
 public:
  using Time = std::chrono::steady_clock::time_point;
  struct Entry {
    Share share;
    Time since;
    T item;
  };

  static constexpr double kSlice = 0.1;
  static constexpr double kMostDebt = 1;
  static constexpr double kPatience = 4;
  // What Pop has charged already.
  static double Paid(const Share& share) { return std::min(share.seconds, kSlice); }

  // Whether another entry of this owner fits: there is room for `bound` of all owners together, and
  // when they are full, still for an equal part of it. A gateway and its users have one part.
  bool HasRoom(const std::string& owner, std::size_t bound) const {
    if (counted_ < bound) return true;
    std::size_t own = 0;
    std::set<std::string_view> payers{PayerOf(owner)};
    for (const auto& [name, each] : owners_) {
      if (!each.waits) continue;
      payers.insert(PayerOf(name));
      if (PayerOf(name) == PayerOf(owner)) own += each.counted;
    }
    return own < bound / payers.size();
  }

  // With `counted` it counts for HasRoom.
  void Push(Entry entry, bool counted) {
    Owner& owner = owners_.try_emplace(entry.share.owner).first->second;
    Flow& flow = owner.flows[entry.share.flow];
    const Time key = KeyOf(entry.share, entry.since);
    ++size_;
    ++owner.waiting;
    owner.expected += entry.share.seconds;
    owner.counted += counted ? 1 : 0;
    counted_ += counted ? 1 : 0;
    flow.waiting.emplace(key, Waiting{std::move(entry), counted});
    Wake(flow, owner.ready, owner.now);
    Wake(owner, ready_, now_);
  }

  // The next entry that is expected to take at most so many seconds.
  std::optional<Entry> Pop(double most = std::numeric_limits<double>::infinity()) {
    return PopWhere([most](const Entry& entry) { return entry.share.seconds <= most; });
  }

  // The next of those entries that `fits` says yes of.
  template <class Fits>
  std::optional<Entry> PopWhere(Fits fits) {
    for (Owner* owner : ready_) {
      for (Flow* flow : owner->ready) {
        const auto found = std::find_if(flow->waiting.begin(), flow->waiting.end(),
                                        [&](const auto& each) { return fits(each.second.entry); });
        if (found != flow->waiting.end()) return Take(*owner, *flow, found);
      }
    }
    return std::nullopt;
  }

  // The owner was served so much more, or less, than was counted.
  void Charge(const Share& share, double seconds) {
    const auto owner = owners_.find(share.owner);
    if (owner == owners_.end()) return;
    Serve(owner->second, ready_, seconds);
    const auto flow = owner->second.flows.find(share.flow);
    if (flow != owner->second.flows.end()) Serve(flow->second, owner->second.ready, seconds);
  }

  // Whether something that waits should go before work that runs and was waiting since `since`; with
  // `others`, something of another owner.
  bool Precedes(const Share& running, Time since, bool others = false) const {
    if (ready_.empty()) return false;
    const Owner& next = **ready_.begin();
    const auto ours = owners_.find(running.owner);
    if (ours == owners_.end()) return true;
    if (&next != &ours->second) return next.served < ours->second.served;
    return !others && (*next.ready.begin())->waiting.begin()->first < KeyOf(running, since);
  }

  // Whether an entry of this owner that is pushed now would be the next to be taken.
  bool WouldBeNext(const std::string& owner) const {
    if (ready_.empty()) return true;
    const auto found = owners_.find(owner);
    const bool known = found != owners_.end();
    if (known && found->second.waits) return false;  // what it has there may be older
    const double served = known ? std::clamp(found->second.served, now_, now_ + kMostDebt) : now_;
    return served < (*ready_.begin())->served;
  }

  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  std::optional<Time> oldest() const {
    std::optional<Time> oldest;
    for (const Owner* owner : ready_) {
      for (const Flow* flow : owner->ready) {
        for (const auto& [key, each] : flow->waiting) {
          oldest = std::min(oldest.value_or(each.entry.since), each.entry.since);
        }
      }
    }
    return oldest;
  }

  // What a newcomer of this owner would find.
  struct Outlook {
    std::size_t place = 0;  // entries of its owner before it
    double seconds = 0;     // until they are done, when all owners that wait take turns
  };
  Outlook OutlookOf(const std::string& owner) const {
    const auto found = owners_.find(owner);
    if (found == owners_.end() || !found->second.waits) return {0, 0};
    return {found->second.waiting, found->second.expected * static_cast<double>(ready_.size())};
  }

 private:
  struct Waiting {
    Entry entry;
    bool counted = false;
  };
  struct Account {
    double served = 0;
    std::uint64_t order = 0;  // among equals: who has waited longer
    bool waits = false;
  };
  template <class Node>
  struct ServedLess {
    bool operator()(const Node* a, const Node* b) const {
      return std::tie(a->served, a->order) < std::tie(b->served, b->order);
    }
  };
  template <class Node>
  using Ready = std::set<Node*, ServedLess<Node>>;
  struct Flow : Account {
    std::multimap<Time, Waiting> waiting;
  };
  struct Owner : Account {
    std::map<std::uint64_t, Flow> flows;
    Ready<Flow> ready;
    double now = 0;  // what the flow whose turn it is was served
    std::size_t waiting = 0;
    std::size_t counted = 0;
    double expected = 0;
  };

  static Time KeyOf(const Share& share, Time since) {
    constexpr double kLongest = 1e6;
    const std::chrono::duration<double> later(std::min(share.seconds, kLongest) * kPatience);
    return since + std::chrono::duration_cast<Time::duration>(later);
  }

  template <class Node>
  void Wake(Node& node, Ready<Node>& ready, double now) {
    if (std::exchange(node.waits, true)) return;
    node.served = std::clamp(node.served, now, now + kMostDebt);
    node.order = ++order_;
    ready.insert(&node);
  }

  template <class Node>
  static void Serve(Node& node, Ready<Node>& ready, double seconds) {
    if (node.waits) ready.erase(&node);
    node.served += seconds;
    if (node.waits) ready.insert(&node);
  }

  template <class Node>
  static void Sleep(Node& node, Ready<Node>& ready) {
    ready.erase(&node);
    node.waits = false;
  }

  Entry Take(Owner& owner, Flow& flow, typename std::multimap<Time, Waiting>::iterator at) {
    // Not what the taken one was served: short work may be taken before its turn.
    now_ = std::max(now_, (*ready_.begin())->served);
    owner.now = std::max(owner.now, (*owner.ready.begin())->served);
    const bool counted = at->second.counted;
    Entry entry = std::move(at->second.entry);
    flow.waiting.erase(at);
    --size_;
    --owner.waiting;
    owner.expected -= entry.share.seconds;
    owner.counted -= counted ? 1 : 0;
    counted_ -= counted ? 1 : 0;
    if (flow.waiting.empty()) Sleep(flow, owner.ready);
    if (owner.waiting == 0) {
      Sleep(owner, ready_);
      owner.expected = 0;  // of sums and differences something is always left
    }
    Charge(entry.share, Paid(entry.share));
    Forget(owner.flows, owner.ready.size());
    Forget(owners_, ready_.size());
    return entry;
  }

  // Those that do not wait, when there are many of them.
  template <class Nodes>
  static void Forget(Nodes& nodes, std::size_t ready) {
    constexpr std::size_t kKept = 1'024;
    if (nodes.size() <= 2 * ready + kKept) return;
    std::erase_if(nodes, [](const auto& each) { return !each.second.waits; });
  }

  std::map<std::string, Owner> owners_;
  Ready<Owner> ready_;
  double now_ = 0;  // what the owner whose turn it is was served
  std::size_t size_ = 0;
  std::size_t counted_ = 0;
  std::uint64_t order_ = 0;
};

}  // namespace arap::runtime
