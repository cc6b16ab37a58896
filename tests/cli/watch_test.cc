// arapctl watch against an admin page that says what a test wants.
#include <atomic>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <httplib.h>
#include <nlohmann/json.hpp>

#include "tests/cli/run.h"

namespace arap::cli {
namespace {

using testing::HasSubstr;

class WatchCommand : public testing::Test {
 protected:
  WatchCommand() {
    server_.Get("/metrics", [this](const httplib::Request&, httplib::Response& response) {
      const int reading = readings_++;
      response.set_content("arapd_sessions 7\narapd_rejected_total{quota=\"queue\"} " +
                               std::to_string(100 * reading) + "\n",
                           "text/plain");
    });
    port_ = server_.bind_to_any_port("127.0.0.1");
    thread_ = std::thread([this] { server_.listen_after_bind(); });
    while (!server_.is_running()) std::this_thread::yield();
  }
  ~WatchCommand() override {
    server_.stop();
    thread_.join();
  }
  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }

  httplib::Server server_;
  std::atomic<int> readings_ = 0;
  int port_ = 0;
  std::thread thread_;
};

TEST_F(WatchCommand, ShowsOneInterval) {
  const Outcome screen = Arapctl({"watch", address(), "--once", "--interval", "0.1"});
  ASSERT_EQ(screen.code, 0) << screen.err;
  EXPECT_THAT(screen.out, HasSubstr("sessions 7 "));
  EXPECT_THAT(screen.out, HasSubstr("refused           1000.0\n"));
  EXPECT_EQ(readings_, 2);
  const Outcome json = Arapctl({"watch", address(), "--once", "--interval", "0.1", "--json"});
  const auto view = nlohmann::json::parse(json.out, nullptr, false);
  ASSERT_TRUE(view.is_object()) << json.out;
  EXPECT_EQ(view["sessions"], 7);
  EXPECT_NEAR(view["refused_per_second"].get<double>(), 1000, 1e-6);
}

TEST_F(WatchCommand, SaysWhatIsWrong) {
  EXPECT_EQ(Arapctl({"watch"}).code, 2);
  EXPECT_EQ(Arapctl({"watch", "nowhere"}).code, 2);
  EXPECT_EQ(Arapctl({"watch", address(), "--interval", "0"}).code, 2);
  const std::string gone = address();
  server_.stop();
  const Outcome outcome = Arapctl({"watch", gone, "--once", "--json"});
  EXPECT_EQ(outcome.code, 6);
  EXPECT_THAT(outcome.out, HasSubstr("\"unavailable\""));
}

}  // namespace
}  // namespace arap::cli
