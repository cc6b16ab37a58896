// The table of errors in docs/protocol.md says what the code does.
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "proto/convert/status.h"
#include "tests/system/wire/wire_fixture.h"

namespace arap::rpc {
namespace {

// "REASON" → "CODE, yes|no" (RetryInfo), from the rows "| `REASON` | CODE | yes | …".
std::map<std::string, std::string> Table() {
  std::ifstream file(ARAP_PROTOCOL_PAGE);
  EXPECT_TRUE(file) << ARAP_PROTOCOL_PAGE;
  std::map<std::string, std::string> rows;
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("| `")) continue;
    std::istringstream cells(line.substr(1));
    std::string reason, code, retry;
    std::getline(cells, reason, '|');
    std::getline(cells, code, '|');
    std::getline(cells, retry, '|');
    const auto trim = [](const std::string& text) {
      const auto first = text.find_first_not_of(" `");
      return text.substr(first, text.find_last_not_of(" `") - first + 1);
    };
    EXPECT_TRUE(rows.emplace(trim(reason), trim(code) + ", " + trim(retry)).second) << reason;
  }
  return rows;
}

TEST(ErrorTableTest, SaysWhatTheCodeDoes) {
  const std::map<std::string, std::string> table = Table();
  std::map<std::string, std::string> code;
  for (int i = 0; i <= static_cast<int>(FaultKind::kInternal); ++i) {
    const auto kind = static_cast<FaultKind>(i);
    const auto error = wire::Decode(convert::ToGrpcStatus({kind, "A sentence."}));
    const FaultInfo& info = InfoOf(kind);
    code[std::string(info.reason)] = std::string(CodeName(static_cast<int>(info.code))) + ", " +
                                     (error.retry_seconds > 0 ? "yes" : "no");
  }
  EXPECT_EQ(table, code);
}

}  // namespace
}  // namespace arap::rpc
