// arapctl plan: its queue against what theory says of queues, its sums, and its words.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "client/cli/plan/capacity.h"
#include "client/cli/plan/queueing.h"
#include "tests/cli/run.h"

namespace arap::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

// Pollaczek and Khinchine: the mean time in a queue with one worker and arrivals by chance.
TEST(Queueing, MeanIsThatOfTheory) {
  for (const double use : {0.3, 0.6, 0.8}) {
    for (const double variation : {0.0, 0.5, 1.0}) {
      constexpr double kService = 0.001;
      const QueueTimes times = SimulateQueue(
          {.rate = use / kService, .workers = 1, .service = kService, .variation = variation});
      const double wait = use * kService * (1 + variation * variation) / (2 * (1 - use));
      ASSERT_TRUE(times.stable);
      EXPECT_NEAR(times.utilization, use, 1e-12);
      EXPECT_NEAR(times.mean, kService + wait, 0.08 * (kService + wait)) << use << " " << variation;
      EXPECT_LE(times.p50, times.p90);
      EXPECT_LE(times.p90, times.p99);
    }
  }
}

TEST(Queueing, EvenStreamsWaitLessThanChanceAndTwoWorkersLessThanOne) {
  const QueueInput chance{.rate = 700, .workers = 1, .service = 0.001};
  QueueInput even = chance, two = chance, alone = chance;
  even.streams = 10;
  two.rate = 1'400;
  two.workers = 2;
  alone.streams = 1;
  EXPECT_LT(SimulateQueue(even).mean, SimulateQueue(chance).mean);
  EXPECT_LT(SimulateQueue(two).mean, SimulateQueue(chance).mean);
  EXPECT_NEAR(SimulateQueue(alone).p99, 0.001, 1e-9) << "nobody is in its way";
  EXPECT_EQ(SimulateQueue(even).p99, SimulateQueue(even).p99) << "the same again";
  QueueInput full = chance;
  full.rate = 1'001;
  EXPECT_FALSE(SimulateQueue(full).stable);
  EXPECT_EQ(SimulateQueue(full).p99, 0);
}

TEST(Capacity, GrowsWithWhatIsAsked) {
  const Puppets base{.count = 1'000, .vertices = 1'000, .fps = 30, .handles = 8, .meshes = 10};
  const Plan plan = MakePlan(base, {}, 0);
  const auto more = [&base](double Puppets::*member) {
    Puppets puppets = base;
    puppets.*member *= 2;
    return MakePlan(puppets, {}, 0);
  };
  for (double Puppets::*member : {&Puppets::count, &Puppets::vertices, &Puppets::handles}) {
    EXPECT_GT(more(member).for_cores, plan.for_cores);
    EXPECT_GT(more(member).for_memory, plan.for_memory);
  }
  EXPECT_NEAR(more(&Puppets::fps).for_cores, 2 * plan.for_cores, 1e-9);
  EXPECT_NEAR(more(&Puppets::count).for_network, 2 * plan.for_network, 1e-9);
  EXPECT_EQ(more(&Puppets::fps).for_memory, plan.for_memory);
  EXPECT_GT(more(&Puppets::meshes).for_memory, plan.for_memory);
  EXPECT_GE(plan.servers, plan.for_cores);
  // Half of the servers have twice as much to do.
  const Plan half = MakePlan(base, {}, plan.servers / 2);
  EXPECT_NEAR(half.core_use, 2 * plan.core_use, 1e-9);
}

TEST(Capacity, NamesWhatIsTooLittleFirst) {
  const Puppets still{.count = 10'000, .vertices = 10'000, .fps = 0.01, .handles = 32};
  EXPECT_EQ(MakePlan(still, {}, 0).bound, Scarce::kMemory);
  const Puppets quick{.count = 1'000, .vertices = 1'000, .fps = 60};
  EXPECT_EQ(MakePlan(quick, {}, 0).bound, Scarce::kCores);
  Machine thin;
  thin.network = 1e6;
  EXPECT_EQ(MakePlan(quick, thin, 0).bound, Scarce::kNetwork);
  // As many meshes as puppets: each server holds those of its own.
  const Puppets each{.count = 10'000, .vertices = 1'000, .fps = 1, .meshes = 10'000};
  EXPECT_TRUE(std::isfinite(MakePlan(each, {}, 0).servers));
  // A mesh that no server has room for.
  const Puppets huge{.count = 2, .vertices = 1e6, .fps = 1, .meshes = 2};
  Machine small;
  small.memory = 1e9;
  EXPECT_FALSE(std::isfinite(MakePlan(huge, small, 0).servers));
}

class PlanCommand : public FolderTest {};

TEST_F(PlanCommand, AnswersInWordsAndInJson) {
  const std::vector<std::string> words{"plan", "--puppets", "10000", "--vertices",
                                       "1000", "--fps",     "30"};
  const Outcome said = Arapctl(words);
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("10000 puppets of 1000 vertices and 8 handles"));
  EXPECT_THAT(said.out, HasSubstr("What is too little first: cores"));
  EXPECT_THAT(said.out, HasSubstr("µs")) << "an update takes less than a millisecond";
  EXPECT_THAT(said.out, Not(HasSubstr("0.00")));
  EXPECT_EQ(Arapctl(words).out, said.out) << "the same again";
  auto with_json = words;
  with_json.emplace_back("--json");
  const Outcome outcome = Arapctl(with_json);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["updates_per_second"], 300'000.0);
  EXPECT_EQ(json["bound"], "cores");
  EXPECT_TRUE(json["stable"].get<bool>());
  EXPECT_GT(json["time_micros"]["p99"].get<double>(), json["update"]["core_micros"].get<double>());
  EXPECT_LE(json["use"]["cores"].get<double>(), 0.7);
  EXPECT_GT(json["use"]["cores"].get<double>(), 0.5) << "but a server less would be too few";
  // With fewer servers than are wanted.
  with_json.insert(with_json.end(), {"--replicas", "3"});
  const auto few = nlohmann::json::parse(Arapctl(with_json).out);
  EXPECT_FALSE(few["stable"].get<bool>());
  EXPECT_GT(few["use"]["cores"].get<double>(), 1);
  EXPECT_THAT(Arapctl({"plan", "--puppets", "2", "--vertices", "1000000", "--meshes", "2", "--fps",
                       "1", "--memory", "1"})
                  .out,
              HasSubstr("do not fit"));
}

TEST_F(PlanCommand, TakesTheTimeOfAnUpdateThatWasMeasured) {
  const Outcome outcome =
      Arapctl({"plan", "--puppets", "10", "--vertices", "1000", "--fps", "10", "--cores", "1",
               "--replicas", "1", "--update-micros", "5000", "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_NEAR(json["use"]["cores"].get<double>(), 0.5, 1e-9);
  EXPECT_NEAR(json["update"]["core_micros"].get<double>(), 5'000, 1e-6);
  EXPECT_GE(json["time_micros"]["mean"].get<double>(), 5'000 * 0.99);
}

TEST_F(PlanCommand, WrongCommandLinesAreTold) {
  for (const std::vector<std::string>& more :
       std::vector<std::vector<std::string>>{{"--puppets", "0"},
                                             {"--puppets", "nan"},
                                             {"--vertices", "2"},
                                             {"--vertices", "2000000"},
                                             {"--fps", "0"},
                                             {"--handles", "0"},
                                             {"--meshes", "0"},
                                             {"--replicas", "0"},
                                             {"--cores", "0"},
                                             {"--memory", "0"},
                                             {"--network", "0"},
                                             {"--update-micros", "0"},
                                             {"--use", "100"}}) {
    std::vector<std::string> words{"plan"};
    for (const char* flag : {"--puppets", "--vertices", "--fps"}) {
      if (more[0] == flag) continue;
      words.insert(words.end(), {flag, "10"});
    }
    words.insert(words.end(), more.begin(), more.end());
    EXPECT_EQ(Arapctl(words).code, 2) << testing::PrintToString(more);
  }
  EXPECT_EQ(Arapctl({"plan", "--puppets", "10"}).code, 2);
}

}  // namespace
}  // namespace arap::cli
