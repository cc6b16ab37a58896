// info and load against a private server.
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "client/cli/report.h"
#include "tests/cli/run.h"

namespace arap::cli {
namespace {

using testing::HasSubstr;

class LoadCommand : public FolderTest {};

TEST_F(LoadCommand, InfoTellsVersionLimitsAndCapabilities) {
  const Outcome text = Arapctl({"info", "--spawn"});
  ASSERT_EQ(text.code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("version"));
  EXPECT_THAT(text.out, HasSubstr("max_vertices"));
  std::istringstream lines(text.out);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
  const Outcome json = Arapctl({"info", "--spawn", "--json"});
  ASSERT_EQ(json.code, 0) << json.err;
  const auto info = nlohmann::json::parse(json.out, nullptr, false);
  ASSERT_TRUE(info.is_object()) << json.out;
  EXPECT_GT(info["limits"]["max_vertices"], 0);
  EXPECT_GT(info["workers"], 0);
}

TEST_F(LoadCommand, CountsUpdatesWithoutErrors) {
  const Outcome outcome =
      Arapctl({"load", "--spawn", "--streams", "2", "--connections", "2", "--seconds", "1",
               "--vertices", "300", "--json", Path("load.json")});
  ASSERT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("errors       none"));
  const auto json = nlohmann::json::parse(Slurp(Path("load.json")), nullptr, false);
  ASSERT_TRUE(json.is_object());
  EXPECT_GT(json["updates"], 2);
  EXPECT_TRUE(json["errors"].empty());
  EXPECT_GT(json["round_trip_micros"]["p50"], 0);
  EXPECT_GT(json["solve_micros"]["p50"], 0);
}

TEST_F(LoadCommand, MeasuresTheTransportByItself) {
  const Outcome outcome =
      Arapctl({"load", "--spawn", "--streams", "2", "--seconds", "0.3", "--transport", "0.3",
               "--vertices", "300", "--json", Path("load.json")});
  ASSERT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("/s by itself, p50"));
  const auto json = nlohmann::json::parse(Slurp(Path("load.json")), nullptr, false);
  ASSERT_TRUE(json.is_object());
  EXPECT_GT(json["transport"]["round_trip_micros"]["count"], 0);
  EXPECT_GT(json["updates"], 0);
}

TEST_F(LoadCommand, WritesItsReportsAndComparesThem) {
  const std::vector<std::string> command{"load",        "--spawn",
                                         "--streams",   "1",
                                         "--seconds",   "1",
                                         "--vertices",  "300",
                                         "--json",      Path("load.json"),
                                         "--csv",       Path("load.csv"),
                                         "--html",      Path("load.html"),
                                         "--threshold", "errors<0.1%",
                                         "--threshold", "drag.p99<1000s"};
  const Outcome outcome = Arapctl(command);
  ASSERT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("threshold    drag.p99<1000s  met"));
  EXPECT_THAT(Slurp(Path("load.csv")), testing::StartsWith("start,seconds,operation,"));
  EXPECT_THAT(Slurp(Path("load.html")), testing::EndsWith("</html>\n"));
  const std::vector<std::string> compare{"load", "compare", Path("load.json"), Path("load.json")};
  const Outcome compared = Arapctl(compare);
  EXPECT_EQ(compared.code, 0) << compared.err;
  EXPECT_THAT(compared.out, HasSubstr("change"));
  std::vector<std::string> strict = compare;
  strict.insert(strict.end(), {"--threshold", "p50<-1%", "--json"});
  const Outcome missed = Arapctl(strict);
  EXPECT_EQ(missed.code, 9);
  const auto json = nlohmann::json::parse(missed.out, nullptr, false);
  ASSERT_TRUE(json.is_object()) << missed.out;
  EXPECT_EQ(json["thresholds"][0]["met"], false);
}

TEST_F(LoadCommand, AMissedThresholdHasAnExitCodeOfItsOwn) {
  const Outcome outcome = Arapctl({"load", "--spawn", "--streams", "1", "--seconds", "1",
                                   "--vertices", "300", "--threshold", "p50<1us", "--json", "-"});
  EXPECT_EQ(outcome.code, 9) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("1 of 1 thresholds missed"));
  const auto json = nlohmann::json::parse(outcome.out, nullptr, false);
  ASSERT_TRUE(json.is_object()) << outcome.out;
  EXPECT_EQ(json["thresholds"][0]["threshold"], "p50<1us");
}

TEST_F(LoadCommand, ComparisonsNameTheFileThatIsWrong) {
  for (const auto& [text, expected] :
       {std::pair("{\"a\": 1}", "load --json"), std::pair("{", "not JSON"),
        std::pair("{\"round_trip_micros\": {}}", "older arapctl")}) {
    std::ofstream(Path("x.json")) << text;
    const Outcome outcome = Arapctl({"load", "compare", Path("x.json"), Path("x.json")});
    EXPECT_EQ(outcome.code, 3);
    EXPECT_THAT(outcome.err, HasSubstr("x.json"));
    EXPECT_THAT(outcome.err, HasSubstr(expected));
  }
  EXPECT_EQ(Arapctl({"load", "compare", "/nowhere.json", "/nowhere.json"}).code, 4);
  EXPECT_EQ(Arapctl({"load", "compare", Path("x.json")}).code, 2);
}

TEST_F(LoadCommand, KeepsARate) {
  const Outcome outcome = Arapctl({"load", "--spawn", "--streams", "2", "--seconds", "1", "--fps",
                                   "20", "--vertices", "300", "--json", Path("load.json")});
  ASSERT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  const auto json = nlohmann::json::parse(Slurp(Path("load.json")), nullptr, false);
  ASSERT_TRUE(json.is_object());
  EXPECT_GT(json["updates"], 2);
  EXPECT_LE(json["updates"], 2 * 21) << "no faster than told";
}

TEST_F(LoadCommand, DoesWhatTheMixSaysAndVerifiesWhatItGets) {
  const Outcome outcome =
      Arapctl({"load", "--spawn", "--streams", "4", "--sessions", "2", "--count", "200",
               "--vertices", "100", "--mix", "drag=6,edit=1,bake=1,flatten=1,register=1",
               "--verify", "1", "--window", "2", "--json", Path("load.json")});
  ASSERT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  const auto json = nlohmann::json::parse(Slurp(Path("load.json")), nullptr, false);
  ASSERT_TRUE(json.is_object());
  std::uint64_t all = 0;
  for (const char* name : {"drag", "edit", "bake", "flatten", "register"}) {
    const auto& operation = json["operations"][name];
    EXPECT_GT(operation["answered"], 0) << name;
    EXPECT_EQ(operation["answered"], operation["sent"]) << name;
    EXPECT_GT(operation["verified"], 0) << name;
    EXPECT_EQ(operation["wrong"], 0) << name;
    all += operation["answered"].get<std::uint64_t>();
  }
  EXPECT_EQ(all, 200u);
}

TEST_F(LoadCommand, BendsTheMeshOfAFile) {
  ASSERT_EQ(
      Arapctl({"sample", "character", "--out", Path("bear.obj"), "--track", Path("wave.json")})
          .code,
      0);
  for (const std::string& handles : {std::string("12"), Path("wave.json")}) {
    const Outcome outcome =
        Arapctl({"load", "--spawn", "--streams", "1", "--count", "10", "--mesh", Path("bear.obj"),
                 "--handles", handles, "--verify", "1", "--encoding", "int16-le", "--delivery",
                 "latest", "--json", Path("load.json")});
    ASSERT_EQ(outcome.code, 0) << outcome.out << outcome.err;
    const auto json = nlohmann::json::parse(Slurp(Path("load.json")), nullptr, false);
    EXPECT_EQ(json["handles"], handles == "12" ? 12 : 5);
    EXPECT_GT(json["operations"]["drag"]["verified"], 0);
    EXPECT_EQ(json["operations"]["drag"]["wrong"], 0);
  }
}

TEST_F(LoadCommand, ErrorsAreCountedByReasonAndFailTheCommand) {
  const Outcome outcome = Arapctl({"load", "--spawn", "--streams", "2", "--seconds", "0.1",
                                   "--vertices", "1100000", "--handles", "2"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.out, HasSubstr("MESH_TOO_LARGE"));
  EXPECT_THAT(outcome.err, HasSubstr("first error"));
}

TEST(Percentiles, OfOneToAHundred) {
  std::vector<double> samples;
  for (int i = 100; i >= 1; --i) samples.push_back(i);
  const Percentiles percentiles = PercentilesOf(samples);
  EXPECT_EQ(percentiles.p50, 50);
  EXPECT_EQ(percentiles.p90, 90);
  EXPECT_EQ(percentiles.p99, 99);
  EXPECT_EQ(percentiles.max, 100);
}

TEST(Percentiles, OfOneSampleAreThatSample) {
  const Percentiles percentiles = PercentilesOf({7});
  EXPECT_EQ(percentiles.p50, 7);
  EXPECT_EQ(percentiles.p99, 7);
  EXPECT_EQ(percentiles.max, 7);
}

TEST(Percentiles, OfNothingAreZero) { EXPECT_EQ(PercentilesOf({}).max, 0); }

}  // namespace
}  // namespace arap::cli
