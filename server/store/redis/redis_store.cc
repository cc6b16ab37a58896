#include "server/store/redis/redis_store.h"

#include <algorithm>
#include <charconv>
#include <random>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/base/try.h"
#include "server/store/record_format.h"
#include "server/store/store.h"

namespace arap::store {
namespace {

std::string PlaceOf(const SessionKey& key) {
  return fmt::format("{}:{}:{}", key.owner.size(), key.owner, key.id);
}

std::string RandomName() {
  std::random_device random;
  return fmt::format("{:08x}{:08x}{:08x}", random(), random(), random());
}

std::string BlobsOf(const SessionRecord& record) {
  std::string blobs;
  for (const auto& [id, mesh] : record.meshes) blobs += mesh.blob + " ";
  return blobs;
}

// Words of a text that are separated by one space each.
template <class Use>
void ForEachWord(std::string_view text, const Use& use) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    if (end > 0) use(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
}

std::size_t ToNumber(std::string_view digits) {
  std::size_t number = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), number);
  return number;
}

RedisCommand LoadCommand(std::string session) {
  return {"HMGET", std::move(session), "revision", "expires", "record"};
}

// From the answer to LoadCommand; nothing when there is none.
Result<std::optional<SessionRecord>> RecordOf(const SessionKey& key, const RedisReply& reply) {
  const std::vector<std::string> fields = reply.Texts();
  if (fields.size() != 3) return Fail(LostRecord(key));
  if (fields[0].empty() && fields[2].empty()) return std::nullopt;
  auto record = DecodeRecord(fields[2]);
  std::int64_t expires = 0;
  const char* end = fields[1].data() + fields[1].size();
  const auto read = std::from_chars(fields[1].data(), end, expires);
  if (!record || record->key != key || std::to_string(record->revision) != fields[0] ||
      read.ec != std::errc{} || read.ptr != end) {
    return Fail(LostRecord(key));
  }
  record->expires = FromMillis(expires);
  return *std::move(record);
}

}  // namespace

RedisSpecStore::RedisSpecStore(RedisOptions options)
    : prefix_(std::move(options.prefix)),
      writer_(RandomName()),
      pool_(std::move(options.url), options.timeout) {}

std::vector<std::string> RedisSpecStore::KeysOf(const SessionKey& key) const {
  return {Key("session:" + PlaceOf(key)), Key("ids:" + key.owner), Key("counts:" + key.owner),
          Key("owners"), Key("expiry")};
}

std::string RedisSpecStore::NewToken() { return fmt::format("{}-{}", writer_, ++writes_); }

Result<std::optional<SessionRecord>> RedisSpecStore::Load(const SessionKey& key) {
  TRY(const auto reply, pool_.Run(LoadCommand(KeysOf(key)[0])));
  return RecordOf(key, reply);
}

Result<std::optional<std::uint64_t>> RedisSpecStore::Revision(const SessionKey& key) {
  TRY(const auto reply, pool_.Run(RedisCommand{"HGET", KeysOf(key)[0], "revision"}));
  if (reply.IsNil()) return std::nullopt;
  return ToNumber(reply.Text());
}

Result<bool> RedisSpecStore::Put(const SessionRecord& record) {
  TRY(auto text, EncodeRecord(record));
  const SessionKey& key = record.key;
  auto reply = pool_.Run(scripts_.put, KeysOf(key),
                         {std::to_string(record.revision - 1), std::to_string(record.revision),
                          NewToken(), std::move(text), std::to_string(ToMillis(record.expires)),
                          fmt::format("{} {}", record.meshes.size(), record.handle_sets.size()),
                          BlobsOf(record), key.id, key.owner, PlaceOf(key)});
  if (!reply) return Fail(reply.error());
  return reply->Int() == 1;
}

Result<bool> RedisSpecStore::Extend(const SessionKey& key, runtime::Clock::Wall expires) {
  TRY(const auto reply, pool_.Run(scripts_.extend, {KeysOf(key)[0], Key("expiry")},
                                  {std::to_string(ToMillis(expires)), PlaceOf(key)}));
  return reply.Int() == 1;
}

Result<bool> RedisSpecStore::Remove(const SessionKey& key) {
  TRY(const auto reply, pool_.Run(scripts_.remove, KeysOf(key), {key.id, key.owner, PlaceOf(key)}));
  return reply.Int() == 1;
}

Result<std::vector<SessionRecord>> RedisSpecStore::List(const std::string& owner,
                                                        const std::string& after,
                                                        std::size_t limit) {
  std::vector<SessionRecord> records;
  std::string last = after;
  for (bool more = true; more && records.size() < limit;) {
    const std::size_t want = limit - records.size();
    TRY(const auto ids, pool_.Run(RedisCommand{"ZRANGEBYLEX", Key("ids:" + owner), "(" + last, "+",
                                               "LIMIT", "0", std::to_string(want)}));
    const std::vector<std::string> names = ids.Texts();
    if (names.empty()) break;
    std::vector<RedisCommand> loads;
    loads.reserve(names.size());
    for (const std::string& id : names) loads.push_back(LoadCommand(KeysOf({owner, id})[0]));
    TRY(const auto replies, pool_.Run(loads));
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (replies[i].IsError()) return Fail(FaultOf(replies[i]));
      auto record = RecordOf({owner, names[i]}, replies[i]);
      if (record && *record) records.push_back(**std::move(record));
    }
    more = names.size() == want;
    last = names.back();
  }
  return records;
}

Result<std::vector<std::string>> RedisSpecStore::Owners() {
  TRY(const auto reply, pool_.Run(RedisCommand{"ZRANGEBYLEX", Key("owners"), "-", "+"}));
  return reply.Texts();
}

Result<Usage> RedisSpecStore::UsageOf(const std::string& owner) {
  TRY(const auto reply, pool_.Run(RedisCommand{"HVALS", Key("counts:" + owner)}));
  Usage usage;
  for (const std::string& counts : reply.Texts()) {
    const std::size_t space = std::min(counts.find(' '), counts.size());
    ++usage.sessions;
    usage.meshes += ToNumber(std::string_view(counts).substr(0, space));
    usage.handle_sets +=
        ToNumber(std::string_view(counts).substr(std::min(space + 1, counts.size())));
  }
  return usage;
}

Result<std::size_t> RedisSpecStore::Count() {
  TRY(const auto reply, pool_.Run(RedisCommand{"ZCARD", Key("expiry")}));
  return static_cast<std::size_t>(reply.Int());
}

Result<std::vector<SessionKey>> RedisSpecStore::RemoveExpired(runtime::Clock::Wall now,
                                                              std::size_t limit) {
  // Expiries were rounded up; so this is rounded down.
  const auto millis = std::chrono::floor<std::chrono::milliseconds>(now.time_since_epoch());
  TRY(const auto reply,
      pool_.Run(scripts_.remove_expired, {Key("owners"), Key("expiry")},
                {prefix_, std::to_string(millis.count()), std::to_string(limit)}));
  const std::vector<std::string> names = reply.Texts();
  std::vector<SessionKey> removed;
  for (std::size_t i = 0; i + 1 < names.size(); i += 2) removed.push_back({names[i], names[i + 1]});
  return removed;
}

Result<std::set<std::string>> RedisSpecStore::ReferencedBlobs() {
  std::set<std::string> blobs;
  std::string cursor = "0";
  do {
    TRY(const auto reply, pool_.Run(scripts_.referenced, {}, {prefix_, cursor}));
    const std::vector<std::string> found = reply.Texts();
    if (found.empty()) return Fail(Unavailable("Redis did not answer what was asked"));
    cursor = found[0];
    for (std::size_t i = 1; i < found.size(); ++i) {
      ForEachWord(found[i], [&](std::string_view blob) { blobs.emplace(blob); });
    }
  } while (cursor != "0");
  return blobs;
}

Status RedisSpecStore::Probe() {
  TRY(const auto reply, pool_.Run(RedisCommand{"PING"}));
  return {};
}

}  // namespace arap::store
