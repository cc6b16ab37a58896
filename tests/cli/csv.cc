#include "tests/cli/csv.h"

#include <charconv>
#include <limits>

namespace arap::cli {
namespace {

// Cuts off what comes before the first separator, or everything.
std::string_view Cut(std::string_view& text, char separator) {
  const std::size_t end = text.find(separator);
  const std::string_view piece = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return piece;
}

double Number(std::string_view text) {
  double value = std::numeric_limits<double>::quiet_NaN();
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

}  // namespace

Csv ParseCsv(std::string_view text) {
  Csv csv;
  csv.header = Cut(text, '\n');
  while (!text.empty()) {
    std::string_view line = Cut(text, '\n');
    csv.frames.push_back(static_cast<std::size_t>(Number(Cut(line, ','))));
    std::vector<double>& row = csv.rows.emplace_back();
    while (!line.empty()) row.push_back(Number(Cut(line, ',')));
  }
  return csv;
}

}  // namespace arap::cli
