// What a run of load is told as: JSON and back, text, CSV, the page, the line of progress.
#include <algorithm>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <unistd.h>

#include "client/cli/load/reports.h"
#include "client/cli/report.h"
#include "client/cli/terminal.h"
#include "tests/cli/made_results.h"

namespace arap::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

std::vector<std::string> LinesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

nlohmann::ordered_json FullJson() {
  return nlohmann::ordered_json::parse(JsonText(ToJson(FullResults())));
}

TEST(LoadResultsJson, ThereAndBackIsTheSame) {
  const nlohmann::ordered_json json = FullJson();
  const Result<LoadResults> read = LoadResultsFromJson(json);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(JsonText(ToJson(*read)), JsonText(json));
  EXPECT_EQ(read->operations[Operation::kDrag].response.Buckets(),
            FullResults().operations[Operation::kDrag].response.Buckets());
  EXPECT_EQ(read->rate_found, 200);
  EXPECT_EQ(read->errors.at(0).first, "The queue is <full> & more.");
  const nlohmann::ordered_json sorted = nlohmann::json(json);  // as readers of files have it
  EXPECT_TRUE(LoadResultsFromJson(sorted));
  EXPECT_FALSE(LoadResultsFromJson(nlohmann::ordered_json::parse(JsonText(ToJson(MadeResults()))))
                   ->rate_found);
}

TEST(LoadResultsJson, KeepsTheNamesThatScriptsGoBy) {
  const nlohmann::ordered_json json = FullJson();
  EXPECT_EQ(json["streams"], 4);
  EXPECT_EQ(json["connections"], 1);
  EXPECT_EQ(json["vertices"], 2500);
  EXPECT_EQ(json["handles"], 8);
  EXPECT_EQ(json["seconds"], 6);
  EXPECT_EQ(json["updates"], 600);
  EXPECT_EQ(json["updates_per_second"], 100);
  for (const char* const name :
       {"round_trip_micros", "queue_micros", "solve_micros", "refused_micros"}) {
    for (const char* const member : {"p50", "p90", "p99", "max"}) {
      EXPECT_GT(json[name][member], 0) << name << " " << member;
    }
  }
  EXPECT_EQ(json["streams_refused"], 3);
  EXPECT_EQ(json["errors"]["OVERLOADED"], 11);
}

TEST(LoadResultsJson, OfARunWithoutAnythingHasNoNumberThatIsNone) {
  const std::string text = JsonText(ToJson(LoadResults()));
  EXPECT_THAT(text, Not(HasSubstr("null")));
  EXPECT_TRUE(LoadResultsFromJson(nlohmann::ordered_json::parse(text)));
}

TEST(LoadResultsJson, NamesWhatIsWrong) {
  const nlohmann::ordered_json good = FullJson();
  const auto refused = [](const nlohmann::ordered_json& json) {
    const Result<LoadResults> read = LoadResultsFromJson(json);
    return read ? std::string("nothing is wrong") : read.error().message;
  };
  EXPECT_THAT(refused(nlohmann::ordered_json::array()), HasSubstr("load --json"));
  EXPECT_THAT(refused({{"hello", 1}}), HasSubstr("load --json"));
  using Pointer = nlohmann::ordered_json::json_pointer;
  struct Case {
    const char* where;
    nlohmann::ordered_json value;
    const char* expected;
  };
  const std::vector<Case> cases{
      {"/version", 2u, "newer"},
      {"/version", 0u, "without histograms"},
      {"/operations/drag/sent", -1, "operations.drag.sent is no count"},
      {"/operations/drag/sent", "12", "operations.drag.sent is no count"},
      {"/operations/drag/response_micros/buckets/129.3", 1u, "response_micros is no histogram"},
      {"/operations/drag/response_micros/buckets/x", 1, "no bucket"},
      {"/operations/drag/response_micros/max", -2, "response_micros.max is no number"},
      {"/operations/dance", nlohmann::ordered_json::object(), "operations.dance is no operation"},
      {"/operations", 3, "operations is no object"},
      {"/intervals", 3, "intervals is no list"},
      {"/intervals/1/seconds", "x", "intervals[1].seconds"},
      {"/intervals/1", 7, "intervals[1].start is not there"},
      {"/steps/0/met", 1, "steps[0].met"},
      {"/error_kinds/0/first", 1, "error_kinds[0].first is no text"},
      {"/seconds", nullptr, "seconds is no number"},
  };
  for (const Case& one : cases) {
    nlohmann::ordered_json json = good;
    json[Pointer(one.where)] = one.value;
    EXPECT_THAT(refused(json), HasSubstr(one.expected)) << one.where;
  }
  nlohmann::ordered_json old = good;
  old.erase("version");
  EXPECT_THAT(refused(old), HasSubstr("older arapctl"));
}

TEST(LoadText, HasEightyColumnsAndEverything) {
  const std::string text = LoadText(FullResults(), STDIN_FILENO);
  for (const std::string& line : LinesOf(text)) EXPECT_LE(CharactersIn(line), kLineWidth) << line;
  for (const char* const part :
       {"updates      600\n", "updates/s    100.0\n", "after 2.00 to warm up", "drag", "edit",
        "  response ", "  solve ", "rate found   200.0 a second", "60 answers computed here too",
        "1 wrong", "3 streams, told after", "2 times, 4 updates lost", "echo", "2.50 µs",
        "2000/s by itself, p50 9", "error        OVERLOADED × 11 (RESOURCE_EXHAUSTED)",
        "error        BAD_REPLY × 1"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
  EXPECT_THAT(LoadText(MadeResults(), STDIN_FILENO), HasSubstr("errors       none\n"));
  EXPECT_THAT(LoadText(LoadResults(), STDIN_FILENO), HasSubstr("updates      0\n"));
}

TEST(LoadCsv, HasALineForEachIntervalAndOperation) {
  const std::vector<std::string> lines = LinesOf(LoadCsv(FullResults()));
  ASSERT_EQ(lines.size(), 1u + 6 * 2);
  const auto commas = std::count(lines[0].begin(), lines[0].end(), ',');
  for (const std::string& line : lines) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), commas) << line;
  }
  EXPECT_THAT(lines[1], testing::StartsWith("0,1,drag,100,100,0,100.000,100.000,"));
  EXPECT_THAT(lines[5], testing::StartsWith("2,1,drag,100,100,12,"));
}

TEST(LoadHtml, LoadsNothingAndRunsNothing) {
  const std::string html = LoadHtml(FullResults(), {});
  for (const char* const part :
       {"<script", "http:", "https:", "src=", "href=", "url(", "@import"}) {
    EXPECT_EQ(html.find(part), std::string::npos) << part;
  }
  for (const char* const part : {"default-src 'none'", "prefers-color-scheme: dark"}) {
    EXPECT_NE(html.find(part), std::string::npos) << part;
  }
}

TEST(LoadHtml, HasItsPicturesWithTitlesAndTheSameFiguresAsTables) {
  const std::string html = LoadHtml(FullResults(), {});
  for (const char* const part :
       {"drag: response times over time", "drag: percentiles", "drag: rates over time",
        "edit: percentiles", "Response times against the offered rate", "200.0/s found",
        "The run by intervals", "BAD_REPLY", "The queue is &lt;full&gt; &amp; more.", "--mix"}) {
    EXPECT_NE(html.find(part), std::string::npos) << part;
  }
  for (const char* const number : {"nan\"", "nan ", "inf\"", "inf ", "nanL"}) {
    EXPECT_EQ(html.find(number), std::string::npos) << number;
  }
}

// What stands in the card of that name.
std::string CardOf(const std::string& html, const std::string& name) {
  const std::size_t at = html.find("<dt>" + name + "</dt>");
  const std::size_t begin = html.rfind("<div class=\"", at);
  return at == std::string::npos ? "none" : html.substr(begin, html.find("</div>", at) - begin);
}

TEST(LoadHtml, WhatAThresholdLetsPassIsNotRed) {
  const LoadResults results = FullResults();
  EXPECT_THAT(CardOf(LoadHtml(results, {}), "errors"), HasSubstr("card bad"));
  EXPECT_THAT(CardOf(LoadHtml(results, {}), "verified"), HasSubstr("card bad"));
  for (const auto& [rule, red] :
       {std::pair("errors<5%", false), std::pair("errors<1", true), std::pair("p99<60s", true)}) {
    const auto threshold = ParseThreshold(rule);
    ASSERT_TRUE(threshold) << rule;
    const std::string html = LoadHtml(results, Judge(std::vector{*threshold}, results));
    EXPECT_EQ(CardOf(html, "errors").find("card bad") != std::string::npos, red) << rule;
  }
  const auto wrong = ParseThreshold("wrong<5");
  ASSERT_TRUE(wrong);
  const std::string html = LoadHtml(results, Judge(std::vector{*wrong}, results));
  EXPECT_THAT(CardOf(html, "verified"), testing::Not(HasSubstr("bad")));
  EXPECT_THAT(CardOf(LoadHtml(MadeResults(), {}), "errors"), HasSubstr("card good"));
}

TEST(LoadText, OfOneHasNoPlural) {
  LoadResults results = MadeResults();
  results.resumptions = results.frames_lost = 1;
  results.operations[Operation::kDrag].verified = 1;
  results.refused.Record(1500);
  const std::string text = LoadText(results, STDIN_FILENO);
  for (const char* const part :
       {"resumed      1 time, 1 update lost", "1 answer computed", "1 stream, told"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
}

// Every element is closed in order, as far as this page writes them.
TEST(LoadHtml, IsWellFormed) {
  for (const LoadResults& results : {FullResults(), MadeResults(1), LoadResults()}) {
    const std::string html = LoadHtml(results, {});
    std::vector<std::string> open;
    for (std::size_t at = html.find('<'); at != std::string::npos; at = html.find('<', at + 1)) {
      const std::size_t end = html.find('>', at);
      ASSERT_NE(end, std::string::npos);
      const std::string tag = html.substr(at + 1, end - at - 1);
      const std::string name = tag.substr(0, tag.find_first_of(" /\n", 1));
      if (tag.starts_with("!") || name == "meta" || name == "br" || tag.ends_with("/")) continue;
      if (!tag.starts_with("/")) {
        open.push_back(name);
        continue;
      }
      ASSERT_FALSE(open.empty()) << tag;
      EXPECT_EQ("/" + open.back(), tag);
      open.pop_back();
    }
    EXPECT_TRUE(open.empty());
  }
}

TEST(Sparkline, ShowsTheHighestOfEachPart) {
  EXPECT_EQ(Sparkline({1, 4, 8}, 10), "▂▅█");
  EXPECT_EQ(Sparkline({1, 8, 0, 0, 1, 1}, 3), "█ ▂");
  EXPECT_EQ(Sparkline({0, 0}, 4), "  ");
  EXPECT_EQ(Sparkline({}, 4), "");
  EXPECT_EQ(CharactersIn(Sparkline(std::vector<double>(240, 1), 48)), 48u);
}

TEST(ProgressText, FitsALine) {
  EXPECT_EQ(ProgressText({12, 60, false, 998.54, 1234, 56'789, 3}),
            "48 s left  998.5/s  p50 1.23 ms  p99 56.8 ms  errors 3");
  EXPECT_EQ(ProgressText({12.5, 0, false, 0, 0, 0, 0}), "12 s  0.0/s  errors 0");
  EXPECT_LE(CharactersIn(ProgressText({0, 9e4, true, 1'234'567.8, 9e8, 9e8, 12'345'678})),
            kLineWidth);
}

}  // namespace
}  // namespace arap::cli
