#include "server/app/session_registry.h"

#include <utility>

#include <fmt/format.h>

#include "server/app/names.h"

namespace arap::app {
namespace {

Fault BadOption(std::string message, std::string field) {
  return {FaultKind::kInvalidOption, std::move(message), {}, {}, std::move(field)};
}

Status CheckSpec(const SessionSpec& spec, const Limits& limits) {
  if (auto name = CheckName(spec.id, "session_id"); !name) return name;
  if (spec.ttl < kMinTtl || spec.ttl > limits.max_ttl) {
    const double max_seconds = std::chrono::duration<double>(limits.max_ttl).count();
    Fault fault =
        BadOption(fmt::format("The ttl of {} s is not between 1 s and {} s.",
                              std::chrono::duration<double>(spec.ttl).count(), max_seconds),
                  "ttl");
    return Fail(fault.Detail("limit", fmt::format("{}", max_seconds)).Detail("quota", "max_ttl"));
  }
  if (spec.labels.size() > kMaxLabels) {
    Fault fault =
        BadOption(fmt::format("There are {} labels, more than {}.", spec.labels.size(), kMaxLabels),
                  "labels");
    return Fail(fault.Detail("count", std::to_string(spec.labels.size()))
                    .Detail("limit", std::to_string(kMaxLabels)));
  }
  for (const auto& [key, value] : spec.labels) {
    if (key.empty() || key.size() > kMaxLabelBytes || value.size() > kMaxLabelBytes) {
      Fault fault = BadOption(
          fmt::format("The label {} is empty or longer than {} bytes.", Quote(key), kMaxLabelBytes),
          "labels");
      return Fail(fault.Detail("limit", std::to_string(kMaxLabelBytes)));
    }
  }
  return {};
}

void EndAll(const std::vector<std::shared_ptr<Session>>& sessions) {
  for (const auto& session : sessions) session->End();
}

}  // namespace

std::vector<std::shared_ptr<Session>> SessionRegistry::TakeExpiredLocked() {
  std::vector<std::shared_ptr<Session>> expired;
  std::erase_if(sessions_, [&](const auto& entry) {
    if (!entry.second->expired()) return false;
    expired.push_back(entry.second);
    return true;
  });
  return expired;
}

Result<SessionView> SessionRegistry::Create(SessionSpec spec) {
  if (spec.ttl == std::chrono::milliseconds::zero()) spec.ttl = limits_.default_ttl;
  if (auto good = CheckSpec(spec, limits_); !good) return Fail(std::move(good.error()));

  std::vector<std::shared_ptr<Session>> expired;
  Result<SessionView> answer;
  {
    const std::lock_guard lock(mutex_);
    expired = TakeExpiredLocked();
    if (const auto found = sessions_.find(spec.id); found != sessions_.end()) {
      if (found->second->spec() == spec && found->second->Touch()) {
        answer = found->second->View();
      } else {
        Fault fault{FaultKind::kAlreadyExists,
                    fmt::format("The session id {} is in use with another ttl or other labels.",
                                Quote(spec.id)),
                    {},
                    {},
                    {}};
        answer = Fail(fault.Detail("resource", "session").Detail("id", spec.id));
      }
    } else if (sessions_.size() >= limits_.max_sessions) {
      answer = Fail(QuotaFull("max_sessions", limits_.max_sessions));
    } else {
      auto session = std::make_shared<Session>(std::move(spec), clock_);
      sessions_.emplace(session->spec().id, session);
      answer = session->View();
    }
  }
  EndAll(expired);
  return answer;
}

Result<std::shared_ptr<Session>> SessionRegistry::Find(const std::string& id) {
  std::shared_ptr<Session> session;
  {
    const std::lock_guard lock(mutex_);
    const auto found = sessions_.find(id);
    if (found == sessions_.end()) return Fail(NotFound("session", id));
    session = found->second;
    if (!session->expired()) return session;
    sessions_.erase(found);
  }
  session->End();
  return Fail(NotFound("session", id));
}

Result<std::shared_ptr<Session>> SessionRegistry::Use(const std::string& id) {
  auto session = Find(id);
  if (!session) return session;
  if (auto alive = (*session)->Touch(); !alive) return Fail(std::move(alive.error()));
  return session;
}

Result<SessionView> SessionRegistry::View(const std::string& id) {
  return Find(id).map([](const std::shared_ptr<Session>& session) { return session->View(); });
}

Result<SessionPage> SessionRegistry::List(std::size_t size, const std::string& token) {
  if (size > kMaxPageSize) {
    Fault fault = BadOption(fmt::format("The page size of {} is more than {}.", size, kMaxPageSize),
                            "page_size");
    return Fail(fault.Detail("limit", std::to_string(kMaxPageSize)));
  }
  if (!token.empty() && !IsName(token)) {
    return Fail(BadOption("The page token was not given by this server.", "page_token"));
  }
  if (size == 0) size = kDefaultPageSize;

  std::vector<std::shared_ptr<Session>> expired;
  SessionPage page;
  {
    const std::lock_guard lock(mutex_);
    expired = TakeExpiredLocked();
    auto next = sessions_.upper_bound(token);
    for (; next != sessions_.end() && page.sessions.size() < size; ++next) {
      page.sessions.push_back(next->second->View());
    }
    if (next != sessions_.end()) page.next_token = page.sessions.back().spec.id;
  }
  EndAll(expired);
  return page;
}

Status SessionRegistry::Delete(const std::string& id) {
  auto session = Find(id);
  if (!session) return Fail(std::move(session.error()));
  {
    const std::lock_guard lock(mutex_);
    const auto found = sessions_.find(id);
    if (found == sessions_.end() || found->second != *session) {
      return Fail(NotFound("session", id));
    }
    sessions_.erase(found);
  }
  (*session)->End();
  return {};
}

}  // namespace arap::app
