// What arapd is told: precedence, --check-config, and what is said of it in the log.
#include "server/config/config.h"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/store/redis/redis_url.h"
#include "tests/system/fault/server_process.h"

namespace arap::fault {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// How it ended, and all that it said.
struct Said {
  int code = -1;
  std::string text;
};

class ConfigTest : public ::testing::Test {
 protected:
  std::string Put(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }

  // `arapd words…` with these variables, to its end.
  Said Run(const std::vector<std::string>& words, const std::vector<std::string>& variables = {}) {
    std::vector<std::string> all{"/usr/bin/env"};
    all.insert(all.end(), variables.begin(), variables.end());
    all.push_back(ARAPD);
    all.insert(all.end(), words.begin(), words.end());
    ChildProcess process;
    const std::string errors = folder_ / "stderr";
    std::filesystem::remove(errors);
    Said said;
    if (!process.Launch(all, errors)) return said;
    while (const auto line = process.ReadLine("", std::chrono::seconds(30))) {
      said.text += *line + "\n";
    }
    said.code = process.Wait(std::chrono::seconds(30)).value_or(-1);
    std::ostringstream text;
    text << std::ifstream(errors).rdbuf();
    said.text += text.str();
    return said;
  }

  TempFolder folder_;
};

// The setting of that name: its value and source.
std::string Setting(const config::Outcome& outcome, const std::string& name) {
  for (const auto& setting : outcome.settings) {
    if (setting.name == name) return setting.value + " " + setting.source;
  }
  return "nothing";
}

TEST_F(ConfigTest, FlagBeatsEnvironmentBeatsFileBeatsDefault) {
  const std::string file = Put("arapd.toml",
                               "workers = 11\n"
                               "job-workers = 11\n"
                               "queue = 11\n"
                               "reflection = false\n"
                               "listen = [\"127.0.0.1:1\", \"127.0.0.1:2\"]\n");
  const auto read =
      config::Read({"--config", file, "--workers", "33"},
                   {"ARAPD_WORKERS=22", "ARAPD_JOB_WORKERS=22", "ARAPD_NONSENSE=1", "PATH=/bin"});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->config.host.lanes.workers, 33u);
  EXPECT_EQ(read->config.host.lanes.job_workers, 22u);
  EXPECT_EQ(read->config.host.limits.max_queued_jobs, 11u);
  EXPECT_EQ(read->config.host.reflection, false);
  EXPECT_THAT(read->config.host.listen, ::testing::ElementsAre("127.0.0.1:1", "127.0.0.1:2"));
  EXPECT_EQ(Setting(*read, "workers"), "33 flag");
  EXPECT_EQ(Setting(*read, "job-workers"), "22 environment");
  EXPECT_EQ(Setting(*read, "queue"), "11 file");
  EXPECT_EQ(Setting(*read, "max-vertices"), "1000000 default");
  EXPECT_THAT(read->unknown, ::testing::ElementsAre("ARAPD_NONSENSE"));
}

TEST_F(ConfigTest, EnvironmentNamesTheFileListsAndSwitches) {
  const std::string file = Put("arapd.toml", "queue = 11\nno-admin = true\n");
  const auto read = config::Read({}, {"ARAPD_CONFIG=" + file, "ARAPD_LISTEN=unix:/a,127.0.0.1:0",
                                      "ARAPD_REFLECTION=true", "ARAPD_QUEUE="});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->config.host.limits.max_queued_jobs, 11u) << "an empty variable says nothing";
  EXPECT_TRUE(read->config.host.admin.empty());
  EXPECT_EQ(read->config.host.reflection, true);
  EXPECT_THAT(read->config.host.listen, ::testing::ElementsAre("unix:/a", "127.0.0.1:0"));
}

TEST_F(ConfigTest, SecondsAndLimitsReachTheirPlaces) {
  const auto read = config::Read({"--max-ttl-seconds", "10", "--default-ttl-seconds", "20",
                                  "--stuck-seconds", "0.5", "--max-stream-idle-seconds", "7"},
                                 {});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->config.host.limits.max_ttl, std::chrono::seconds(10));
  EXPECT_EQ(read->config.host.limits.default_ttl, std::chrono::seconds(10));
  EXPECT_EQ(read->config.host.stuck_after, std::chrono::milliseconds(500));
  EXPECT_EQ(read->config.host.limits.max_stream_idle, std::chrono::seconds(7));
}

TEST_F(ConfigTest, SessionsAreKeptInTheStateDirectory) {
  const auto store = [](const std::vector<std::string>& environment) {
    return config::Read({}, environment)->config.host.store.store;
  };
  EXPECT_EQ(store({"HOME=/h", "XDG_STATE_HOME=/x", "STATE_DIRECTORY=/s:/t"}), "sqlite:/s");
  EXPECT_EQ(store({"HOME=/h", "XDG_STATE_HOME=/x"}), "sqlite:/x/arapd");
  EXPECT_EQ(store({"HOME=/h"}), "sqlite:/h/.local/state/arapd");
  EXPECT_EQ(store({}), "sqlite:/var/lib/arapd");
  EXPECT_EQ(store({"HOME=/h", "ARAPD_STORE=memory"}), "memory");
}

TEST_F(ConfigTest, PasswordsAreNotShown) {
  const auto read = config::Read({"--store", "redis://:w0rd@host:1"}, {});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->config.host.store.store, "redis://:w0rd@host:1");
  EXPECT_EQ(Setting(*read, "store"), "redis://:***@host:1 flag");
  EXPECT_EQ(config::Redacted("redis://user:w@rd@host:1/0"), "redis://user:***@host:1/0");
  EXPECT_EQ(config::Redacted("redis://w0rd@host"), "redis://***@host");
  EXPECT_EQ(config::Redacted("redis://:a/b@host:1"), "redis://***");
  EXPECT_EQ(config::Redacted("redis://host:1/0"), "redis://host:1/0");
  EXPECT_EQ(config::Redacted("sqlite:/var/lib/a@b"), "sqlite:/var/lib/a@b");
}

TEST_F(ConfigTest, PasswordOfRedisIsReadFromItsFile) {
  const std::string file = Put("password", "w0rd\n");
  const auto store = [&](const std::string& url) {
    const auto read = config::Read({"--store", url, "--redis-password-file", file}, {});
    return read ? read->config.host.store.store : read.error().message;
  };
  EXPECT_EQ(store("redis://host:1/2"), "redis://:w0rd@host:1/2");
  EXPECT_EQ(store("redis://user@host"), "redis://user:w0rd@host");
  EXPECT_EQ(store("rediss+sentinel://user@a,b/main"), "rediss+sentinel://user:w0rd@a,b/main");
  EXPECT_EQ(store("redis+cluster://a:1,b"), "redis+cluster://:w0rd@a:1,b");
  EXPECT_THAT(store("redis://:other@host"), HasSubstr("a password too"));
  EXPECT_THAT(store("memory"), HasSubstr("--redis-password-file"));
}

TEST_F(ConfigTest, PasswordsInFilesMayHaveAnyCharacter) {
  const std::string file = Put("odd", "a%41/@:,b\n"), guard = Put("guard", "g\n");
  const auto read = config::Read({"--store", "redis+sentinel://u@h/m", "--redis-password-file",
                                  file, "--redis-sentinel-password-file", guard},
                                 {"ARAPD_REDIS_REPLICAS=2"});
  ASSERT_TRUE(read) << read.error().message;
  const auto url = store::ParseRedisUrl(read->config.host.store.store);
  ASSERT_TRUE(url) << url.error().message;
  EXPECT_EQ(url->access.password, "a%41/@:,b");
  EXPECT_EQ(read->config.host.store.redis.sentinel_password, "g");
  EXPECT_EQ(read->config.host.store.redis.replicas, 2);
  EXPECT_EQ(Setting(*read, "redis-replicas"), "2 environment");
  const auto none = config::Read({"--redis-sentinel-password-file", folder_ / "none"}, {});
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().message, HasSubstr("--redis-sentinel-password-file"));
}

TEST_F(ConfigTest, PasswordsAreNotLeftInTheCommandLine) {
  ServerProcess server({"--blob-dir", "redis://user:w0rd@host"});
  ASSERT_TRUE(server.Start());
  std::ostringstream line;
  line << std::ifstream("/proc/" + std::to_string(server.pid()) + "/cmdline").rdbuf();
  EXPECT_THAT(line.str(), HasSubstr("redis://user:***@host"));
  EXPECT_THAT(line.str(), Not(HasSubstr("w0rd")));
}

TEST_F(ConfigTest, WhatIsMadeIsForItsUserAlone) {
  ServerProcess server({"--store", "sqlite:{}/state", "--log-file", "{}/log"}, "unix:{}/socket");
  ASSERT_TRUE(server.Start());
  const std::string& folder = server.folder().path();
  int files = 0;
  for (const auto& file : std::filesystem::recursive_directory_iterator(folder)) {
    if (file.path().filename() == "stderr") continue;
    const auto mode = file.status().permissions() & std::filesystem::perms(0077);
    EXPECT_EQ(mode, std::filesystem::perms::none) << file.path();
    ++files;
  }
  EXPECT_GT(files, 3);
}

TEST_F(ConfigTest, FolderThatAnybodyMayWriteIntoIsRefused) {
  const std::string state = folder_ / "state";
  std::filesystem::create_directory(state);
  std::filesystem::permissions(state, std::filesystem::perms(0777));
  EXPECT_THAT(Run({"--check-config", "--store", "sqlite:" + state}).text, HasSubstr("o-w"));
  ServerProcess server({"--store", "sqlite:" + state});
  EXPECT_EQ(server.StartAndFail(), 1);
}

TEST_F(ConfigTest, CheckSaysGood) {
  const Said good = Run({"--check-config", "--listen", "127.0.0.1:0", "--store",
                         "sqlite:" + folder_ / "state", "--log-file", folder_ / "log"});
  EXPECT_EQ(good.code, 0) << good.text;
  EXPECT_THAT(good.text, HasSubstr("good"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "state")) << "nothing is made";
  EXPECT_FALSE(std::filesystem::exists(folder_ / "log"));
}

TEST_F(ConfigTest, CheckNamesWhatIsWrong) {
  const std::string typo = Put("typo.toml", "wrokers = 1\n");
  const std::string file = Put("file", "");
  struct Case {
    std::vector<std::string> words;
    std::string says;
  };
  for (const Case& bad : std::vector<Case>{
           {{"--workers", "0"}, "--workers"},
           {{"--no-such-flag"}, "--no-such-flag"},
           {{"--config", folder_ / "missing.toml"}, "missing.toml"},
           {{"--config", typo}, "wrokers"},
           {{"--listen", "127.0.0.1:99999"}, "127.0.0.1:99999"},
           {{"--listen", "unix:" + folder_ / "no/where"}, "no/where"},
           {{"--listen", "unix:" + file}, file},
           {{"--admin", "nowhere"}, "nowhere"},
           {{"--log-file", folder_ / "no/log"}, "--log-file"},
           {{"--access-log", folder_.path()}, "--access-log"},
           {{"--log-file", folder_ / "a", "--access-log", folder_ / "a"}, "same file"},
           {{"--store", "mysql:x"}, "--store"},
           {{"--store", "redis://:w0rd@host:1"}, "--blob-dir"},
           {{"--store", "redis+sentinel://:w0rd@host:1", "--blob-dir", "x"}, "NAME"},
           {{"--redis-ca", "x"}, "--redis-ca: It is for rediss://"},
           {{"--store", "rediss://h", "--blob-dir", "x", "--redis-cert", "c"}, "--redis-key"},
           {{"--store", "rediss://h", "--blob-dir", "x", "--redis-ca", "no-ca"}, "no-ca"},
           {{"--redis-replicas", "1"}, "--redis-replicas"},
           {{"--redis-replicas", "17"}, "--redis-replicas"},
           {{"--token-file", folder_ / "no-tokens"}, "no-tokens"},
           {{"--tls-cert", folder_ / "no.pem", "--tls-key", folder_ / "no.pem"}, "no.pem"},
           {{"--listen", "0.0.0.0:0"}, "0.0.0.0:0"},
       }) {
    std::vector<std::string> words{"--check-config"};
    words.insert(words.end(), bad.words.begin(), bad.words.end());
    const Said said = Run(words);
    EXPECT_EQ(said.code, 2) << bad.says << "\n" << said.text;
    EXPECT_THAT(said.text, HasSubstr(bad.says));
    EXPECT_THAT(said.text, Not(HasSubstr("w0rd")));
  }
  const Said variable = Run({"--check-config"}, {"ARAPD_WORKERS=many"});
  EXPECT_EQ(variable.code, 2) << variable.text;
  EXPECT_THAT(variable.text, HasSubstr("--workers"));
}

TEST_F(ConfigTest, HelpAndVersion) {
  EXPECT_EQ(Run({"--version"}).code, 0);
  const Said help = Run({"--help"});
  EXPECT_EQ(help.code, 0);
  EXPECT_THAT(help.text, HasSubstr("--drain-delay"));
}

TEST_F(ConfigTest, EffectiveConfigIsLogged) {
  ServerProcess server({"--queue", "77", "--store", "sqlite:{}/state"});
  ASSERT_TRUE(server.Start());
  EXPECT_THAT(server.Log(), HasSubstr("event=config name=queue value=\"77\" source=flag"));
  EXPECT_THAT(server.Log(), HasSubstr("event=config name=max-handles value=\"1000\" "
                                      "source=default"));
}

}  // namespace
}  // namespace arap::fault
