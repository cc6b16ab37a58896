#include "tests/system/cluster/editors.h"

#include <algorithm>

namespace arap::cluster {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr std::size_t kEditors = 3, kSets = 2;
// Handles of one editor in a set.
constexpr std::size_t kMine = 3;
constexpr std::uint32_t kVerticesEach = 20;
constexpr std::size_t kMostPlanted = 5;

std::string SessionId(std::size_t number) { return "edited-" + std::to_string(number); }
std::string SetId(std::size_t number) { return "set-" + std::to_string(number); }

SetState StateOf(const client::HandleSetInfo& info) {
  SetState state{{}, info.revision};
  for (const client::PlacedHandle& placed : info.handles) state.handles.insert(placed.handle.id);
  return state;
}

// Whether a call that is not repeated may have been done though it was not answered.
bool IsOpen(const Fault& fault) {
  return fault.kind == FaultKind::kDraining || fault.kind == FaultKind::kOverloaded ||
         fault.kind == FaultKind::kStoreUnavailable || fault.kind == FaultKind::kCancelled ||
         fault.kind == FaultKind::kDeadlineExceeded || fault.kind == FaultKind::kInternal;
}

// The answered edits after which there is an answered call on the same set that begins later.
std::vector<std::size_t> EditsThatAreSeen(const std::vector<Call>& history) {
  std::vector<std::size_t> edits;
  for (std::size_t i = 0; i < history.size() && edits.size() < kMostPlanted; ++i) {
    const Call& edit = history[i];
    if (edit.kind != CallKind::kEdit || !edit.end) continue;
    const bool seen = std::any_of(history.begin(), history.end(), [&](const Call& call) {
      return call.set == edit.set && call.end && call.begin > *edit.end;
    });
    if (seen) edits.push_back(i);
  }
  return edits;
}

}  // namespace

Editors::Editors(const std::string& address, const Puppet& puppet, std::size_t sessions,
                 std::uint64_t seed)
    : address_(address), histories_(sessions) {
  const client::Client client = client::Client::Connect(address);
  for (std::size_t number = 0; number < sessions; ++number) {
    client::SessionOptions named;
    named.id = SessionId(number);
    const auto session = client.CreateSession(named, call_);
    if (!Answered("CreateSession", session) ||
        !Answered("RegisterMesh", session->RegisterMesh(puppet.mesh, {}, "m", call_))) {
      continue;
    }
    for (std::size_t set = 0; set < kSets; ++set) {
      Call call{CallKind::kCompile, SetId(set), {"l", "r"}, {}, steady_clock::now(), {}, {}};
      const auto compiled = session->CompileHandles(call.set, "m", puppet.handles, call_);
      if (!Answered("CompileHandles", compiled)) continue;
      call.end = steady_clock::now();
      call.told = StateOf(compiled->handle_set);
      Note(number, std::move(call));
    }
    for (std::size_t editor = 0; editor < kEditors; ++editor) {
      const testing::Random random(seed + number * kEditors + editor);
      Join([this, number, editor, random] { Edit(number, editor, random); });
    }
  }
}

void Editors::Note(std::size_t session, Call call) {
  const std::lock_guard lock(histories_mutex_);
  histories_[session].push_back(std::move(call));
}

void Editors::Edit(std::size_t number, std::size_t editor, testing::Random random) {
  const client::Client client = client::Client::Connect(address_);
  client::Session session = client.AttachSession(SessionId(number));
  std::vector<std::vector<std::string>> mine(kSets);
  for (std::uint32_t turn = 0; !StopWithin(milliseconds(20 + random.Below(80))); ++turn) {
    const std::size_t set = random.Below(kSets);
    if (random.Coin()) {
      Read(session, number, SetId(set));
      continue;
    }
    Call call{CallKind::kEdit, SetId(set), {}, {}, steady_clock::now(), {}, {}};
    call.add.insert(std::to_string(editor) + "-" + std::to_string(turn));
    EditOnce(session, number, std::move(call), mine[set],
             10 + static_cast<std::uint32_t>(editor) * kVerticesEach + turn % kVerticesEach);
  }
}

void Editors::EditOnce(client::Session& session, std::size_t number, Call call,
                       std::vector<std::string>& mine, std::uint32_t vertex) {
  if (mine.size() == kMine) {
    call.remove.insert(mine.front());
    mine.erase(mine.begin());
  }
  const std::vector<std::string> remove(call.remove.begin(), call.remove.end());
  const std::string added = *call.add.begin();
  const std::vector<client::Handle> add{{added, client::VertexAnchor{vertex}}};
  const auto edited = session.EditHandles(call.set, remove, add, call_);
  ++calls_;
  if (edited) {
    call.end = steady_clock::now();
    call.told = StateOf(edited->handle_set);
    mine.push_back(added);
  } else if (!IsOpen(edited.error())) {
    Complain("EditHandles: " + edited.error().message);
  }
  Note(number, std::move(call));
}

void Editors::Read(client::Session& session, std::size_t number, const std::string& set) {
  Call call{CallKind::kRead, set, {}, {}, steady_clock::now(), {}, {}};
  const auto found = session.GetHandleSet(set, call_);
  call.end = steady_clock::now();
  ++calls_;
  if (found) {
    call.told = StateOf(*found);
  } else if (found.error().kind != FaultKind::kNotFound) {  // which the history has to explain
    return Complain("GetHandleSet: " + found.error().message);
  }
  Note(number, std::move(call));
}

const std::vector<std::vector<Call>>& Editors::Histories() {
  const client::Client client = client::Client::Connect(address_);
  for (std::size_t number = 0; number < histories_.size(); ++number) {
    client::Session session = client.AttachSession(SessionId(number));
    for (std::size_t set = 0; set < kSets; ++set) Read(session, number, SetId(set));
  }
  return histories_;
}

Planted PlantLostWrites(const std::vector<Call>& history) {
  Planted planted;
  for (const std::size_t at : EditsThatAreSeen(history)) {
    // Just after an edit, another one was acknowledged, as if nobody had been there in between.
    Call lost = history[at];
    lost.begin = *history[at].end;
    lost.end = lost.begin;
    lost.add = {"lost"};
    lost.remove.clear();
    lost.told->handles.insert("lost");
    ++lost.told->revision;
    std::vector<Call> calls = history;
    calls.push_back(std::move(lost));
    ++planted.planted;
    planted.found += Judge(calls).verdict == Verdict::kWrong ? 1U : 0U;
  }
  return planted;
}

Planted PlantStaleReads(const std::vector<Call>& history) {
  Planted planted;
  for (const std::size_t at : EditsThatAreSeen(history)) {
    // Just after an edit, somebody reads what was there before it.
    Call stale = history[at];
    stale.kind = CallKind::kRead;
    stale.begin = *history[at].end + std::chrono::nanoseconds(1);
    stale.end = stale.begin;
    for (const std::string& handle : stale.add) stale.told->handles.erase(handle);
    stale.told->handles.insert(stale.remove.begin(), stale.remove.end());
    --stale.told->revision;
    stale.add.clear();
    stale.remove.clear();
    std::vector<Call> calls = history;
    calls.push_back(std::move(stale));
    ++planted.planted;
    planted.found += Judge(calls).verdict == Verdict::kWrong ? 1U : 0U;
  }
  return planted;
}

}  // namespace arap::cluster
