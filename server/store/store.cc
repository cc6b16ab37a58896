#include "server/store/store.h"

#include <system_error>

#include <fmt/format.h>

namespace arap::store {

std::int64_t ToMillis(runtime::Clock::Wall time) {
  return std::chrono::ceil<std::chrono::milliseconds>(time.time_since_epoch()).count();
}

runtime::Clock::Wall FromMillis(std::int64_t millis) {
  return runtime::Clock::Wall(std::chrono::milliseconds(millis));
}

std::set<std::string> SessionRecord::Blobs() const {
  std::set<std::string> blobs;
  for (const auto& [id, mesh] : meshes) blobs.insert(mesh.blob);
  for (const auto& [id, job] : jobs) {
    blobs.insert(job.request);
    if (!job.result.empty()) blobs.insert(job.result);
  }
  return blobs;
}

std::size_t SessionRecord::BlobBytes() const {
  std::size_t bytes = 0;
  for (const auto& [id, mesh] : meshes) bytes += mesh.bytes;
  for (const auto& [id, job] : jobs) bytes += job.request_bytes + job.result_bytes;
  return bytes;
}

Fault Unavailable(std::string_view why) {
  Fault fault(FaultKind::kStoreUnavailable,
              fmt::format("The store of sessions cannot serve: {}.", why));
  return fault.Detail("why", std::string(why));
}

Fault UnavailableErrno(int number) { return Unavailable(std::generic_category().message(number)); }

Fault LostRecord(const SessionKey& key) {
  Fault fault(FaultKind::kDataLoss,
              fmt::format("What was stored of the session \"{}\" is damaged.", key.id));
  return fault.Detail("owner", key.owner).Detail("session", key.id);
}

Fault LostBlob(const std::string& hash, std::string_view why) {
  Fault fault(FaultKind::kDataLoss, fmt::format("The stored mesh {} is {}.", hash, why));
  return fault.Detail("blob", hash).Detail("why", std::string(why));
}

}  // namespace arap::store
