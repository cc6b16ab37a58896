// The table of limits, the fields of arap.v1.Limits and docs/operations.md name the same limits.
#include <chrono>
#include <fstream>
#include <set>
#include <string>

#include <arap/v1/server_service.pb.h>
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "arap/model/limits.h"
#include "proto/convert/limits.h"

namespace arap {
namespace {

TEST(LimitTableTest, HasARowForEveryFieldAndAFieldForEveryRow) {
  std::multiset<std::string> fields, rows;
  for (int i = 0; i < v1::Limits::descriptor()->field_count(); ++i) {
    fields.insert(v1::Limits::descriptor()->field(i)->name());
  }
  for (const LimitInfo& info : kLimits) {
    if (info.served) rows.insert(std::string(info.name));
  }
  EXPECT_EQ(rows, fields);
}

TEST(LimitTableTest, HasARowForEveryMember) {
  Limits limits;
  std::uint32_t value = 987'000;
  std::size_t bytes = 0;
  for (const LimitInfo& info : kLimits) {
    VisitLimit(limits, info, [&]<class Value>(Value& member) {
      EXPECT_TRUE(member < Value(987'000) || Value(987'999) < member)
          << info.name << " has the member of a row before it";
      member = Value(++value);
      bytes += sizeof(Value);
    });
  }
  // But for the padding behind the one of 32 bits.
  EXPECT_LT(sizeof(Limits) - bytes, sizeof(std::size_t)) << "a member has no row";
}

TEST(LimitTableTest, SurvivesTheWire) {
  Limits limits;
  std::uint32_t value = 1'000;
  for (const LimitInfo& info : kLimits) {
    VisitLimit(limits, info,
               [&]<class Value>(Value& member) { member = Value(info.served ? ++value : 0u); });
  }
  v1::Limits message;
  convert::ToWire(limits, &message);
  EXPECT_EQ(convert::FromWire(message), limits);
}

// "| `--max-sessions` | `max_sessions` | | 10000 | Sessions on this server |"
std::string PageRow(const LimitInfo& info) {
  const auto code = [](bool there, std::string_view name) {
    return there ? fmt::format("`{}` ", name) : std::string();
  };
  const Limits defaults;
  const std::string number = VisitLimit(defaults, info, []<class Value>(const Value& value) {
    if constexpr (std::is_same_v<Value, std::chrono::milliseconds>) {
      return fmt::format("{}", std::chrono::duration<double>(value).count());
    } else {
      return fmt::format("{}", value);
    }
  });
  return fmt::format("| `--{}` | {}| {}| {} | {} |", FlagName(info), code(info.served, info.name),
                     code(!TokenName(info).empty(), TokenName(info)), number, info.meaning);
}

TEST(LimitTableTest, IsThatOfTheOperatorsPage) {
  std::ifstream file(ARAP_OPERATIONS_PAGE);
  ASSERT_TRUE(file) << ARAP_OPERATIONS_PAGE;
  std::string page, table, expected;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("| `--")) table += line + "\n";
  }
  for (const LimitInfo& info : kLimits) expected += PageRow(info) + "\n";
  EXPECT_EQ(table, expected);
}

}  // namespace
}  // namespace arap
