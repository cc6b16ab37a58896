#include "server/store/redis/redis_store.h"

#include <algorithm>
#include <charconv>
#include <random>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/base/names.h"
#include "core/base/try.h"
#include "core/token/digest.h"
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
  for (const std::string& blob : record.Blobs()) blobs += blob + " ";
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

// The value of "name:value" in what INFO answers; empty when there is none.
std::string ValueOf(const std::string& info, const std::string& name) {
  const std::size_t at = info.find("\n" + name + ":");
  if (at == std::string::npos) return {};
  const std::size_t start = at + name.size() + 2;
  return info.substr(start, info.find_first_of("\r\n", start) - start);
}

RedisCommand LoadCommand(std::string session) {
  return {"HMGET", std::move(session), "revision", "expires", "record", "incarnation"};
}

// From the answer to LoadCommand; nothing when there is none.
Result<std::optional<SessionRecord>> RecordOf(const SessionKey& key, const RedisReply& reply) {
  const std::vector<std::string> fields = reply.Texts();
  if (fields.size() != 4) return Fail(LostRecord(key));
  if (fields[0].empty() && fields[2].empty()) return std::nullopt;
  auto record = DecodeRecord(fields[2]);
  if (!record && record.error().kind == FaultKind::kStoreUnavailable) return Fail(record.error());
  std::int64_t expires = 0;
  const char* end = fields[1].data() + fields[1].size();
  const auto read = std::from_chars(fields[1].data(), end, expires);
  if (!record || record->key != key || std::to_string(record->revision) != fields[0] ||
      read.ec != std::errc{} || read.ptr != end) {
    return Fail(LostRecord(key));
  }
  record->expires = FromMillis(expires);
  // A replica of a version before does not write it into the record.
  record->incarnation = fields[3];
  return *std::move(record);
}

// Of the values of a hash of counts.
Usage SumOfCounts(const std::vector<std::string>& values) {
  Usage usage;
  for (const std::string& counts : values) {
    std::vector<std::size_t> numbers;
    ForEachWord(counts, [&](std::string_view word) { numbers.push_back(ToNumber(word)); });
    numbers.resize(3);  // a replica of a version before does not write the bytes
    usage += {1, numbers[0], numbers[1], numbers[2]};
  }
  return usage;
}

}  // namespace

RedisSpecStore::RedisSpecStore(const RedisOptions& options)
    : prefix_(PrefixOf(options)),
      fails_over_(options.url.kind != RedisUrl::Kind::kServer),
      replicas_(options.replicas),
      writer_(RandomName()),
      pool_(options) {}

std::vector<std::string> RedisSpecStore::KeysOf(const SessionKey& key) const {
  return {Key("session:" + PlaceOf(key)), Key("ids:" + key.owner), Key("counts:" + key.owner),
          Key("owners"), Key("expiry")};
}

std::string RedisSpecStore::NewToken() { return fmt::format("{}-{}", writer_, ++writes_); }

Result<std::optional<SessionRecord>> RedisSpecStore::Load(const SessionKey& key) {
  TRY(const auto reply, pool_.Run(LoadCommand(KeysOf(key)[0])));
  return RecordOf(key, reply);
}

Result<std::optional<RecordVersion>> RedisSpecStore::Version(const SessionKey& key) {
  TRY(const auto reply,
      pool_.Run(RedisCommand{"HMGET", KeysOf(key)[0], "revision", "incarnation"}));
  const std::vector<std::string> fields = reply.Texts();
  if (fields.size() != 2) return Fail(LostRecord(key));
  if (fields[0].empty()) return std::nullopt;
  return RecordVersion{fields[1], ToNumber(fields[0])};
}

Result<bool> RedisSpecStore::Put(const SessionRecord& record) {
  TRY(auto text, EncodeRecord(record));
  const std::size_t bytes = text.size() + record.BlobBytes();
  const SessionKey& key = record.key;
  auto reply =
      pool_.Run(scripts_.put, KeysOf(key),
                {std::to_string(record.revision - 1), std::to_string(record.revision), NewToken(),
                 std::move(text), std::to_string(ToMillis(record.expires)),
                 fmt::format("{} {} {}", record.meshes.size(), record.handle_sets.size(), bytes),
                 BlobsOf(record), key.id, key.owner, PlaceOf(key), record.incarnation});
  if (!reply) return Fail(reply.error());
  return reply->Int() == 1;
}

Result<bool> RedisSpecStore::Extend(const SessionKey& key, const std::string& incarnation,
                                    runtime::Clock::Wall expires) {
  TRY(const auto reply, pool_.Run(scripts_.extend, {KeysOf(key)[0], Key("expiry")},
                                  {std::to_string(ToMillis(expires)), PlaceOf(key), incarnation}));
  return reply.Int() == 1;
}

Result<bool> RedisSpecStore::Remove(const SessionKey& key, std::string expires) {
  std::vector<std::string> keys = KeysOf(key);
  keys.push_back(Key("done:" + NewToken()));
  TRY(const auto reply,
      pool_.Run(scripts_.remove, keys, {key.id, key.owner, PlaceOf(key), std::move(expires)}));
  return reply.Int() == 1;
}

Result<bool> RedisSpecStore::Remove(const SessionKey& key) { return Remove(key, ""); }

Result<bool> RedisSpecStore::RemoveAsOf(const SessionKey& key, runtime::Clock::Wall expires) {
  return Remove(key, std::to_string(ToMillis(expires)));
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
  return SumOfCounts(reply.Texts());
}

Result<Usage> RedisSpecStore::UsageUnder(const std::string& owner) {
  TRY(Usage usage, UsageOf(owner));
  // All names that begin with "OWNER/": the digit 0 comes next after the slash.
  TRY(const auto users,
      pool_.Run(RedisCommand{"ZRANGEBYLEX", Key("owners"), "[" + owner + "/", "(" + owner + "0"}));
  std::vector<RedisCommand> looks;
  for (const std::string& user : users.Texts()) looks.push_back({"HVALS", Key("counts:" + user)});
  if (looks.empty()) return usage;
  TRY(const auto replies, pool_.Run(looks));
  for (const auto& reply : replies) {
    if (reply.IsError()) return Fail(FaultOf(reply));
    usage += SumOfCounts(reply.Texts());
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

// On one connection, for a cursor is good for the server alone that made it: another one, or the
// same one started anew, would pass over sessions in silence. So a break ends it.
Result<std::set<std::string>> RedisSpecStore::ReferencedBlobs() {
  std::set<std::string> blobs;
  std::string cursor = "0";
  TRY(const auto connection, pool_.Alone());
  do {
    TRY(const auto reply, connection->Run(RedisCommand{"EVAL", scripts_.referenced.text, "1",
                                                       Key("no-such-key"), prefix_, cursor}));
    const std::vector<std::string> found = reply.Texts();
    if (found.empty()) return Fail(Unavailable("Redis did not answer what was asked"));
    cursor = found[0];
    for (std::size_t i = 1; i < found.size(); ++i) {
      ForEachWord(found[i], [&](std::string_view blob) { blobs.emplace(blob); });
    }
  } while (cursor != "0");
  return blobs;
}

Result<std::optional<runtime::Clock::Wall>> RedisSpecStore::Time() {
  TRY(const auto reply, pool_.Run(RedisCommand{"TIME"}));
  const std::vector<std::string> parts = reply.Texts();
  if (parts.size() != 2) return Fail(Unavailable("Redis did not answer what was asked"));
  return runtime::Clock::Wall(std::chrono::seconds(ToNumber(parts[0])) +
                              std::chrono::microseconds(ToNumber(parts[1])));
}

Result<StoreFacts> RedisSpecStore::Facts() {
  TRY(const std::string fresh, RandomHex(32));
  TRY(const auto replies, pool_.Change({{"SET", Key("id"), fresh, "NX"},
                                        {"GET", Key("id")},
                                        {"INFO", "memory"},
                                        {"INFO", "persistence"},
                                        {"CONFIG", "GET", "save"},
                                        {"CONFIG", "GET", "min-replicas-to-write"}}));
  // Who may not see how Redis is set up cannot judge it; the id is needed.
  for (const std::size_t needed : {0u, 1u}) {
    if (replies[needed].IsError()) return Fail(FaultOf(replies[needed]));
  }
  StoreFacts facts{replies[1].Text(), {}};
  if (!IsHex(facts.id, 32)) return Fail(Unavailable("Redis did not answer what was asked"));
  const std::string memory = replies[2].Text(), disk = replies[3].Text();
  const std::string policy = ValueOf(memory, "maxmemory_policy");
  if (ToNumber(ValueOf(memory, "maxmemory")) > 0 && !policy.empty() && policy != "noeviction") {
    facts.weaknesses.push_back(
        {"evicts",
         fmt::format("Redis evicts sessions when its memory is full: its maxmemory-policy is {}, "
                     "not noeviction.",
                     policy),
         true});
  }
  const std::vector<std::string> confirmers = replies[5].Texts();
  if (fails_over_ && replicas_ == 0 && confirmers.size() == 2 && confirmers[1] == "0") {
    facts.weaknesses.push_back(
        {"unreplicated",
         "Redis answers before a replica has a change: when another server becomes the master the "
         "last changes may be lost (--redis-replicas, min-replicas-to-write).",
         false});
  }
  if (ValueOf(disk, "aof_enabled") != "0") return facts;
  const std::vector<std::string> save = replies[4].Texts();
  if (save.size() == 2 && save[1].empty()) {
    facts.weaknesses.push_back({"forgets",
                                "Redis keeps nothing when it ends: it has neither an append-only "
                                "file nor snapshots (appendonly, save).",
                                true});
  } else {
    facts.weaknesses.push_back({"flushes_rarely",
                                "Redis writes to disk only now and then: when it ends unexpectedly "
                                "the changes since its last snapshot are lost (appendonly).",
                                false});
  }
  return facts;
}

Status RedisSpecStore::Probe() {
  pool_.Follow();
  TRY(const auto reply, pool_.Run(RedisCommand{"PING"}));
  return {};
}

}  // namespace arap::store
