#include "tests/system/cluster/history.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace arap::cluster {
namespace {

using Sets = std::map<std::string, SetState>;

// What may be the case at a moment: the sets, and which of the calls under way were done already.
struct Possibility {
  Sets sets;
  std::set<std::size_t> done;

  friend bool operator<(const Possibility& a, const Possibility& b) {
    return std::tie(a.done, a.sets) < std::tie(b.done, b.sets);
  }
};

constexpr std::size_t kMostPossibilities = 200'000;

// The sets after a call; nothing when it was answered otherwise.
std::optional<Sets> Do(const Call& call, Sets sets) {
  const auto found = sets.find(call.set);
  std::optional<SetState> after;
  if (found != sets.end()) after = found->second;
  if (call.kind == CallKind::kCompile && !after) after = SetState{call.add, 1};
  if (call.kind == CallKind::kEdit && after) {
    for (const std::string& handle : call.remove) after->handles.erase(handle);
    after->handles.insert(call.add.begin(), call.add.end());
    ++after->revision;
  }
  if (call.end && after != call.told) return std::nullopt;
  if (after) sets[call.set] = *std::move(after);
  return sets;
}

// An edit without an answer whose handles no answer has ever shown: it was done after all of them,
// or never, and explains nothing.
std::vector<bool> UnseenEdits(const std::vector<Call>& calls) {
  std::map<std::string, std::set<std::string>> seen;
  for (const Call& call : calls) {
    if (call.told) seen[call.set].insert(call.told->handles.begin(), call.told->handles.end());
  }
  std::vector<bool> unseen(calls.size());
  for (std::size_t i = 0; i < calls.size(); ++i) {
    const Call& call = calls[i];
    unseen[i] = call.kind == CallKind::kEdit && !call.end &&
                std::none_of(call.add.begin(), call.add.end(), [&](const std::string& handle) {
                  return seen[call.set].contains(handle);
                });
  }
  return unseen;
}

// Every way to go on until `call` is done, by doing others of `under_way` before it.
std::optional<std::set<Possibility>> Until(std::size_t call, const std::set<Possibility>& from,
                                           const std::set<std::size_t>& under_way,
                                           const std::vector<Call>& calls) {
  std::set<Possibility> done, seen = from;
  std::vector<Possibility> open(from.begin(), from.end());
  while (!open.empty()) {
    const Possibility now = std::move(open.back());
    open.pop_back();
    if (now.done.contains(call)) {
      done.insert(now);
      continue;
    }
    for (const std::size_t next : under_way) {
      if (now.done.contains(next)) continue;
      auto sets = Do(calls[next], now.sets);
      if (!sets) continue;
      Possibility then{*std::move(sets), now.done};
      then.done.insert(next);
      if (!seen.insert(then).second) continue;
      if (seen.size() > kMostPossibilities) return std::nullopt;
      open.push_back(std::move(then));
    }
  }
  return done;
}

}  // namespace

std::string Call::Describe(Time start) const {
  const auto at = [&](Time time) { return std::chrono::duration<double>(time - start).count(); };
  constexpr const char* kNames[] = {"compile", "edit", "read"};
  std::string text = fmt::format("{} {}", kNames[static_cast<std::size_t>(kind)], set);
  for (const std::string& handle : add) text += " +" + handle;
  for (const std::string& handle : remove) text += " -" + handle;
  if (!end) return text + fmt::format(" [{:.3f} s, no answer]", at(begin));
  text += fmt::format(" [{:.3f} s, {:.3f} s] → ", at(begin), at(*end));
  if (!told) return text + "no such set";
  return text +
         fmt::format("revision {} of {{{}}}", told->revision, fmt::join(told->handles, ", "));
}

Judgement Judge(const std::vector<Call>& calls) {
  const std::vector<bool> unseen = UnseenEdits(calls);
  // Begins and ends by time. At the same moment begins come first: those calls overlap.
  struct Event {
    Call::Time time;
    bool is_end;
    std::size_t call;
  };
  std::vector<Event> events;
  for (std::size_t i = 0; i < calls.size(); ++i) {
    if (unseen[i]) continue;
    events.push_back({calls[i].begin, false, i});
    if (calls[i].end) events.push_back({*calls[i].end, true, i});
  }
  std::stable_sort(events.begin(), events.end(), [](const Event& a, const Event& b) {
    return std::tie(a.time, a.is_end) < std::tie(b.time, b.is_end);
  });
  std::set<Possibility> possible{{}};
  std::set<std::size_t> under_way;
  for (const Event& event : events) {
    if (!event.is_end) {
      under_way.insert(event.call);
      continue;
    }
    const auto then = Until(event.call, possible, under_way, calls);
    if (!then) return {Verdict::kUndecided, event.call};
    if (then->empty()) return {Verdict::kWrong, event.call};
    // Done in all of them: nobody needs to remember it.
    possible.clear();
    for (Possibility possibility : *then) {
      possibility.done.erase(event.call);
      possible.insert(std::move(possibility));
    }
    under_way.erase(event.call);
  }
  return {};
}

}  // namespace arap::cluster
