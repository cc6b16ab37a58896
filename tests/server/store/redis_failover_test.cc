// Another Redis becomes the master: sentinels promote one, a cluster does, its slot is moved.
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <poll.h>

#include "server/store/redis/redis_store.h"
#include "tests/server/store/records.h"
#include "tests/server/store/redis_server.h"
#include "tests/server/store/store_kind.h"

namespace arap::store {
namespace {

using std::chrono::steady_clock;
using testing::Next;
using testing::PlainRecord;
using testing::RawRedis;
using testing::RedisServer;
using testing::RedisSetup;

bool Eventually(const std::function<bool()>& holds) {
  const auto deadline = steady_clock::now() + std::chrono::seconds(120);
  while (!holds()) {
    if (steady_clock::now() > deadline) return false;
    poll(nullptr, 0, 20);
  }
  return true;
}

std::string Port(const RedisServer& redis) { return std::to_string(redis.port()); }

bool HasRole(const RedisServer& redis, const std::string& role) {
  return RawRedis(redis.Url(), {"ROLE"}).Texts().front() == role;
}

// Sessions with what was acknowledged of each. A change whose fate is unknown is looked up.
class Ledger {
 public:
  explicit Ledger(RedisSpecStore& specs) : specs_(specs) {
    for (int i = 0; i < 5; ++i) records_.push_back(PlainRecord("ann", "s" + std::to_string(i)));
  }

  // A change to every session, tried until it is acknowledged.
  void ChangeAll() {
    for (SessionRecord& record : records_) {
      SessionRecord next = begun_ ? Next(record) : record;
      ASSERT_TRUE(Eventually([&] {
        const auto put = specs_.Put(next);
        if (put && *put) return true;
        if (!put) {
          EXPECT_EQ(put.error().kind, FaultKind::kStoreUnavailable) << put.error().message;
        } else if (const auto version = specs_.Version(next.key); version) {
          // A try before was done after all, or what it had done is gone again.
          next.revision = *version ? (*version)->revision + 1 : 1;
        }
        return false;
      }));
      record = next;
    }
    begun_ = true;
  }

  // What was acknowledged is there: this revision or, where a call did not know, a later one.
  void CheckAll(RedisSpecStore& specs) const {
    for (const SessionRecord& record : records_) {
      Result<std::optional<SessionRecord>> loaded;
      ASSERT_TRUE(Eventually([&] { return (loaded = specs.Load(record.key)).has_value(); }));
      ASSERT_TRUE(loaded->has_value()) << record.key.id << " is lost";
      EXPECT_GE((*loaded)->revision, record.revision) << record.key.id;
    }
    EXPECT_EQ(specs.UsageOf("ann")->sessions, records_.size());
  }
  void Check() const { CheckAll(specs_); }

 private:
  RedisSpecStore& specs_;
  std::vector<SessionRecord> records_;
  bool begun_ = false;
};

// A master, two replicas and a sentinel, whose word is enough.
class SentinelTest : public ::testing::Test {
 protected:
  SentinelTest() {
    for (int i = 0; i < 2; ++i) {
      servers_.push_back(std::make_unique<RedisServer>(
          RedisSetup{"w0rd",
                     {"--masterauth", "w0rd", "--replicaof", "127.0.0.1", Port(*servers_.front()),
                      "--repl-diskless-sync-delay", "0"},
                     {}}));
    }
    const std::string master = Port(*servers_.front());
    sentinel_ = std::make_unique<RedisServer>(RedisSetup{
        {},
        {},
        "requirepass guard\nsentinel monitor main 127.0.0.1 " + master +
            " 1\nsentinel auth-pass main w0rd\nsentinel down-after-milliseconds main 1500\n"
            "sentinel failover-timeout main 5000\n"});
  }

  void SetUp() override {
    ASSERT_TRUE(Eventually([&] {
      return RawRedis(servers_[0]->Url(), {"WAIT", "2", "1"}).Int() == 2 &&
             AskSentinel({"SENTINEL", "ckquorum", "main"}).Text().starts_with("OK") &&
             SentinelSees(2);
    }));
  }

  RedisReply AskSentinel(const RedisCommand& command) const {
    return RawRedis("redis://:guard@127.0.0.1:" + Port(*sentinel_), command);
  }
  bool SentinelSees(std::size_t replicas) const {
    const std::string info = AskSentinel({"INFO", "sentinel"}).Text();
    return info.find("slaves=" + std::to_string(replicas)) != std::string::npos;
  }

  RedisOptions Options() const {
    RedisOptions options;
    // Nobody is at the first place.
    options.url =
        *ParseRedisUrl("redis+sentinel://:w0rd@127.0.0.1:" + std::to_string(testing::FreePort()) +
                       ",127.0.0.1:" + Port(*sentinel_) + "/main");
    options.sentinel_password = "guard";
    options.replicas = 1;
    return options;
  }
  // The one that is it now; nothing while there is none.
  RedisServer* Master(const RedisServer* but) {
    for (const auto& server : servers_) {
      if (server.get() != but && HasRole(*server, "master")) return server.get();
    }
    return nullptr;
  }

  std::vector<std::unique_ptr<RedisServer>> servers_ = First();
  std::unique_ptr<RedisServer> sentinel_;

 private:
  static std::vector<std::unique_ptr<RedisServer>> First() {
    std::vector<std::unique_ptr<RedisServer>> servers;
    servers.push_back(std::make_unique<RedisServer>(
        RedisSetup{"w0rd", {"--masterauth", "w0rd", "--repl-diskless-sync-delay", "0"}, {}}));
    return servers;
  }
};

TEST_F(SentinelTest, WhatWasAcknowledgedSurvivesItsMaster) {
  RedisSpecStore specs(Options()), other(Options());
  Ledger ledger(specs);
  ASSERT_NO_FATAL_FAILURE(ledger.ChangeAll());
  const auto facts = specs.Facts();
  ASSERT_TRUE(facts);
  servers_[0]->Kill();
  ASSERT_NO_FATAL_FAILURE(ledger.ChangeAll()) << "a replica takes over";
  ledger.Check();
  ledger.CheckAll(other);
  EXPECT_EQ(specs.Facts()->id, facts->id);
  EXPECT_EQ(specs.ReferencedBlobs()->size(), 1u);
  servers_[0]->Restart();
  ASSERT_TRUE(Eventually([&] { return HasRole(*servers_[0], "slave"); }));
  ASSERT_NO_FATAL_FAILURE(ledger.ChangeAll());
  ledger.CheckAll(other);
}

// A master that was cut off does not know that it is none any more. What it says is not believed.
TEST_F(SentinelTest, AMasterThatComesBackFromAFreezeAcknowledgesNothing) {
  RedisSpecStore specs(Options()), behind(Options());
  Ledger ledger(specs);
  ASSERT_NO_FATAL_FAILURE(ledger.ChangeAll());
  const SessionRecord record = PlainRecord("bob", "s");
  ASSERT_TRUE(behind.Probe()) << "it has a connection now";
  servers_[0]->Freeze();
  ASSERT_NO_FATAL_FAILURE(ledger.ChangeAll());
  servers_[0]->Thaw();
  ASSERT_TRUE(Eventually([&] { return behind.Put(record) == true; }));
  EXPECT_TRUE(specs.Load(record.key)->has_value()) << "acknowledged by the one and lost";
  ASSERT_TRUE(Eventually([&] { return behind.Probe().has_value(); }));
  ledger.CheckAll(behind);
}

// Without a break of any connection: an operator has moved it.
TEST_F(SentinelTest, AMoveThatBreaksNothingIsFollowed) {
  RedisSpecStore specs(Options());
  Ledger ledger(specs);
  ASSERT_NO_FATAL_FAILURE(ledger.ChangeAll());
  // It looks at its replicas every ten seconds, and promotes none that it has not seen in order.
  ASSERT_TRUE(Eventually([&] {
    return AskSentinel({"SENTINEL", "FAILOVER", "main"}).Text().starts_with("OK");
  }));
  ASSERT_TRUE(Eventually([&] { return Master(servers_[0].get()) != nullptr; }));
  ASSERT_TRUE(Eventually([&] { return specs.Probe().has_value(); }));
  ASSERT_NO_FATAL_FAILURE(ledger.ChangeAll());
  ledger.Check();
}

TEST_F(SentinelTest, WhatIsWrongIsSaid) {
  const auto complaint = [](const RedisOptions& options) {
    const Status probe = RedisSpecStore(options).Probe();
    return probe ? std::string() : probe.error().message;
  };
  RedisOptions options = Options();
  EXPECT_EQ(complaint(options), "");
  options.url.master = "other";
  EXPECT_NE(complaint(options).find("know no master of that name"), std::string::npos);
  options = Options();
  options.sentinel_password = "wrong";
  EXPECT_NE(complaint(options).find("sentinel"), std::string::npos) << complaint(options);
  options = Options();
  options.url.places.pop_back();
  EXPECT_NE(complaint(options).find("no sentinel"), std::string::npos);
  // More replicas than there are: a change that so many do not have does not count.
  options = Options();
  options.replicas = 3;
  options.timeout = std::chrono::milliseconds(400);
  const auto put = RedisSpecStore(options).Put(PlainRecord("ann", "s"));
  ASSERT_FALSE(put);
  EXPECT_NE(put.error().message.find("only 2 of 3 replicas"), std::string::npos)
      << put.error().message;
  // Without any it is told, unless Redis itself sees to it.
  options = Options();
  options.replicas = 0;
  RedisSpecStore trusting(options);
  const auto facts = trusting.Facts();
  ASSERT_TRUE(facts);
  ASSERT_EQ(facts->weaknesses.size(), 1u);
  EXPECT_STREQ(facts->weaknesses[0].reason, "unreplicated");
  EXPECT_FALSE(facts->weaknesses[0].grave);
  RawRedis(servers_[0]->Url(), {"CONFIG", "SET", "min-replicas-to-write", "1"});
  EXPECT_TRUE(trusting.Facts()->weaknesses.empty());
  RawRedis(servers_[0]->Url(), {"CONFIG", "SET", "min-replicas-to-write", "3"});
  const auto refused = trusting.Put(PlainRecord("ann", "t"));
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("NOREPLICAS"), std::string::npos);
}

// Three masters that share the slots, and a replica of the one that has ours.
class ClusterTest : public ::testing::Test {
 protected:
  static constexpr const char* kOurs = "{arap:}";

  ClusterTest() {
    for (int i = 0; i < 4; ++i) {
      nodes_.push_back(std::make_unique<RedisServer>(RedisSetup{
          {},
          {"--cluster-enabled", "yes", "--cluster-port", std::to_string(testing::FreePort()),
           "--cluster-node-timeout", "2000", "--repl-diskless-sync-delay", "0"},
          {}}));
    }
  }

  RedisReply Run(std::size_t node, const RedisCommand& command) const {
    return RawRedis(nodes_[node]->Url(), command);
  }
  std::string Id(std::size_t node) const { return Run(node, {"CLUSTER", "MYID"}).Text(); }
  bool Agree() const {
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const std::string info = Run(i, {"CLUSTER", "INFO"}).Text();
      if (info.find("cluster_state:ok") == std::string::npos ||
          info.find("cluster_known_nodes:4") == std::string::npos) {
        return false;
      }
    }
    return true;
  }

  void SetUp() override {
    slot_ = Run(0, {"CLUSTER", "KEYSLOT", kOurs}).Int();
    const std::int64_t bounds[] = {0, 5461, 10923, 16384};
    for (std::size_t i = 0; i < 3; ++i) {
      Run(i, {"CLUSTER", "ADDSLOTSRANGE", std::to_string(bounds[i]),
              std::to_string(bounds[i + 1] - 1)});
      if (slot_ >= bounds[i] && slot_ < bounds[i + 1]) owner_ = i;
      Run(i, {"CLUSTER", "SET-CONFIG-EPOCH", std::to_string(i + 1)});
    }
    for (std::size_t i = 1; i < nodes_.size(); ++i) {
      const std::string info = Run(i, {"CLUSTER", "NODES"}).Text();
      // "ID HOST:PORT@BUS …"
      const std::string bus = info.substr(
          info.find('@') + 1, info.find_first_of(" ,", info.find('@')) - info.find('@') - 1);
      ASSERT_EQ(Run(0, {"CLUSTER", "MEET", "127.0.0.1", Port(*nodes_[i]), bus}).Text(), "OK");
    }
    ASSERT_TRUE(Eventually([&] { return Agree(); }));
    ASSERT_TRUE(Eventually([&] {
      return Run(3, {"CLUSTER", "REPLICATE", Id(owner_)}).Text() == "OK";
    }));
    ASSERT_TRUE(Eventually([&] { return Run(owner_, {"WAIT", "1", "1"}).Int() == 1; }));
    other_ = (owner_ + 1) % 3;
  }

  // Knows only a node that has not our slot.
  RedisOptions Options() const {
    RedisOptions options;
    options.url = *ParseRedisUrl("redis+cluster://127.0.0.1:" + Port(*nodes_[other_]));
    return options;
  }

  std::vector<std::unique_ptr<RedisServer>> nodes_;
  std::int64_t slot_ = 0;
  std::size_t owner_ = 0, other_ = 0;
};

// Every script keeps to one slot.
TEST_F(ClusterTest, EveryCallWorks) {
  RedisSpecStore specs(Options());
  SessionRecord record = PlainRecord("ann", "s");
  const SessionRecord users = PlainRecord("ann/bob", "s", 'b');
  ASSERT_EQ(specs.Put(record), true);
  ASSERT_EQ(specs.Put(users), true);
  record = Next(record);
  EXPECT_EQ(specs.Put(record), true);
  EXPECT_EQ(**specs.Version(record.key), VersionOf(record));
  EXPECT_EQ(specs.List("ann", "", 10)->size(), 1u);
  EXPECT_EQ(*specs.Owners(), (std::vector<std::string>{"ann", "ann/bob"}));
  EXPECT_EQ(specs.UsageOf("ann")->sessions, 1u);
  EXPECT_EQ(specs.UsageUnder("ann")->sessions, 2u);
  EXPECT_EQ(specs.Count(), 2u);
  EXPECT_EQ(specs.ReferencedBlobs()->size(), 2u);
  EXPECT_TRUE((*specs.Time()).has_value());
  EXPECT_FALSE(specs.Facts()->id.empty());
  record.expires -= std::chrono::hours(3);
  EXPECT_EQ(specs.Extend(record.key, record.incarnation, record.expires), true);
  EXPECT_EQ(testing::Difference(**specs.Load(record.key), record), "");
  EXPECT_EQ(specs.RemoveExpired(testing::Now(), 10)->size(), 1u);
  EXPECT_EQ(specs.RemoveAsOf(users.key, record.expires), false);
  EXPECT_EQ(specs.RemoveAsOf(users.key, users.expires), true);
  ASSERT_EQ(specs.Put(users), true);
  EXPECT_EQ(specs.Remove(users.key), true);
  EXPECT_EQ(specs.Count(), 0u);
}

TEST_F(ClusterTest, AReplicaTakesOver) {
  RedisOptions options = Options();
  options.replicas = 1;
  RedisSpecStore confirmed(options);
  Ledger ledger(confirmed);
  ASSERT_NO_FATAL_FAILURE(ledger.ChangeAll());
  nodes_[owner_]->Kill();
  RedisSpecStore specs(Options());
  ledger.CheckAll(specs);
  EXPECT_EQ(specs.Put(PlainRecord("bob", "s")), true) << "the last of them has no replica";
  nodes_[owner_]->Restart();
  ASSERT_NO_FATAL_FAILURE(ledger.ChangeAll()) << "it is the replica now, and confirms";
  ledger.CheckAll(specs);
}

TEST_F(ClusterTest, ASlotThatMovesIsFollowed) {
  RedisSpecStore specs(Options());
  Ledger ledger(specs);
  ASSERT_NO_FATAL_FAILURE(ledger.ChangeAll());
  const std::string slot = std::to_string(slot_);
  const std::string from = Id(owner_), to = Id(other_);
  ASSERT_EQ(Run(other_, {"CLUSTER", "SETSLOT", slot, "IMPORTING", from}).Text(), "OK");
  ASSERT_EQ(Run(owner_, {"CLUSTER", "SETSLOT", slot, "MIGRATING", to}).Text(), "OK");
  const auto keys = Run(owner_, {"CLUSTER", "GETKEYSINSLOT", slot, "1000"}).Texts();
  ASSERT_GT(keys.size(), 5u);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (i == keys.size() / 2) {
      // Half of the sessions are elsewhere: nobody says that there are no more.
      const auto blobs = specs.ReferencedBlobs();
      ASSERT_FALSE(blobs);
      EXPECT_EQ(blobs.error().kind, FaultKind::kStoreUnavailable);
      EXPECT_FALSE(specs.Put(PlainRecord("bob", "s")));
    }
    ASSERT_EQ(
        Run(owner_, {"MIGRATE", "127.0.0.1", Port(*nodes_[other_]), keys[i], "0", "60000"}).Text(),
        "OK");
  }
  for (const std::size_t node : {other_, owner_, (owner_ + 2) % 3}) {
    ASSERT_EQ(Run(node, {"CLUSTER", "SETSLOT", slot, "NODE", to}).Text(), "OK");
  }
  ASSERT_NO_FATAL_FAILURE(ledger.ChangeAll());
  ledger.Check();
  EXPECT_EQ(specs.ReferencedBlobs()->size(), 1u);
  EXPECT_EQ(specs.Put(PlainRecord("bob", "s")), true);
}

}  // namespace
}  // namespace arap::store
