// Workshop: what the use cases on sessions share — where sessions are kept and what is computed
// from them.
#pragma once

#include <functional>
#include <string>

#include "arap/model/limits.h"
#include "server/budget/derived_cache.h"
#include "server/runtime/clock.h"
#include "server/runtime/metrics.h"
#include "server/sessions/session_registry.h"
#include "server/store/open_store.h"
#include "server/store/store_keeper.h"

namespace arap::app {

// Thread-safe member by member.
struct Workshop {
  // `the_clock` outlives the workshop.
  Workshop(const Limits& the_limits, const runtime::Clock& the_clock, store::Stores the_stores);
  Workshop(const Workshop&) = delete;
  Workshop& operator=(const Workshop&) = delete;

  // Forgets what was computed for a session, or for a handle set or a mesh of it, that is no more.
  void Release(const store::SessionRecord& record);
  void ReleaseHandleSet(const store::SessionKey& session, const std::string& handle_set_id);
  void ReleaseMesh(const std::string& owner, const std::string& blob);

  runtime::Metrics metrics;  // first: the others count in it until their end
  const Limits limits;
  const runtime::Clock& clock;
  const store::Stores stores;
  store::StoreKeeper keeper;
  DerivedCache derived;
  SessionRegistry sessions;
};

}  // namespace arap::app
