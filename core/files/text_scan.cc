#include "core/files/text_scan.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/files/text_file.h"

namespace arap {
namespace {

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
bool EndsLine(char c) { return c == '\n' || c == '\r'; }

constexpr std::size_t kLongestNumber = 100;  // that is looked at once more

tl::unexpected<Fault> Bad(std::string message) {
  return Fail(FaultKind::kInvalidOption, std::move(message));
}

// std::from_chars knows no plus sign.
std::string_view WithoutPlus(std::string_view word) {
  const bool plus = word.size() > 1 && word[0] == '+' && word[1] != '-';
  return word.substr(plus ? 1 : 0);
}

// Whether a decimal number that no double holds is too small for one rather than too large: where
// its first digit stands, that is not zero.
bool IsTiny(std::string_view number) {
  const std::size_t e = number.find_first_of("eE");
  const std::string_view digits = number.substr(0, e);
  std::int64_t exponent = 0;
  if (e != std::string_view::npos) {
    const std::string_view text = WithoutPlus(number.substr(e + 1));
    const auto read = std::from_chars(text.data(), text.data() + text.size(), exponent);
    if (read.ec != std::errc()) return text.starts_with('-');  // beyond any length of the digits
  }
  const auto place = [](std::size_t at) { return static_cast<std::int64_t>(at); };
  const std::size_t point = std::min(digits.find('.'), digits.size());
  const std::size_t first = std::min(digits.find_first_of("123456789"), digits.size());
  return exponent < place(first) - place(point);
}

// The sentence for a word that is no finite number.
tl::unexpected<Fault> NoNumber(std::string_view word) {
  std::string with_points(word.substr(0, kLongestNumber));
  std::replace(with_points.begin(), with_points.end(), ',', '.');
  double number = 0;
  const char* const end = with_points.data() + with_points.size();
  const bool comma = word.find(',') != std::string_view::npos &&
                     std::from_chars(with_points.data(), end, number).ptr == end;
  return Bad(fmt::format("{} is not a number{}", Quoted(word), comma ? " (decimal comma?)" : ""));
}

}  // namespace

TextScanner::TextScanner(std::string_view text)
    : text_(text), at_(text.size() - WithoutByteOrderMark(text).size()) {}

bool TextScanner::BackslashEndsLine(std::size_t at) const {
  if (text_[at] != '\\') return false;
  for (++at; at < text_.size() && IsBlank(text_[at]);) ++at;
  return at == text_.size() || EndsLine(text_[at]);
}

void TextScanner::PassLineEnd() {
  if (at_ == text_.size()) return;
  at_ += text_.substr(at_).starts_with("\r\n") ? std::size_t{2} : std::size_t{1};
  ++line_;
}

std::string_view TextScanner::Word(bool continued) {
  for (;; ++at_) {
    if (at_ == text_.size() || EndsLine(text_[at_]) || text_[at_] == '#') return {};
    if (IsBlank(text_[at_])) continue;
    if (!continued || !BackslashEndsLine(at_)) break;
    for (++at_; at_ < text_.size() && IsBlank(text_[at_]);) ++at_;
    PassLineEnd();
    --at_;  // the loop steps on
  }
  const std::size_t begin = at_;
  for (; at_ < text_.size(); ++at_) {
    const char c = text_[at_];
    if (IsBlank(c) || EndsLine(c) || c == '#' || (continued && BackslashEndsLine(at_))) break;
  }
  return text_.substr(begin, at_ - begin);
}

std::string_view TextScanner::Rest() {
  while (at_ < text_.size() && IsBlank(text_[at_])) ++at_;
  const std::size_t begin = at_;
  while (at_ < text_.size() && !EndsLine(text_[at_])) ++at_;
  std::size_t end = at_;
  while (end > begin && IsBlank(text_[end - 1])) --end;
  return text_.substr(begin, end - begin);
}

std::string_view TextScanner::NextWord() {
  for (;;) {
    const std::string_view word = Word();
    if (!word.empty() || !NextLine()) return word;
  }
}

bool TextScanner::NextLine() {
  while (at_ < text_.size() && !EndsLine(text_[at_])) ++at_;
  PassLineEnd();
  return at_ < text_.size();
}

Status CheckSize(std::string_view bytes, const std::string& name) {
  if (bytes.size() >= std::size_t{1} << 32U) return Bad(name + ": the limit is 4 GiB");
  return {};
}

Status CheckText(std::string_view text, const std::string& name) {
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) {
    return Bad(name + ": the text is in UTF-16; save it as UTF-8");
  }
  return CheckSize(text, name);
}

tl::unexpected<Fault> FailAt(const std::string& name, std::size_t line, std::string_view what) {
  return Bad(fmt::format("{}:{}: {}", name, line, what));
}

std::string Quoted(std::string_view word) {
  constexpr std::size_t kMost = 40;
  return fmt::format("'{}{}'", word.substr(0, kMost), word.size() > kMost ? "…" : "");
}

Result<double> ParseNumber(std::string_view word) {
  const std::string_view text = WithoutPlus(word);
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool whole = end == text.data() + text.size() && !text.empty();
  if (whole && error == std::errc::result_out_of_range) {
    if (!IsTiny(text)) return Bad(fmt::format("{} is too large for a number", Quoted(word)));
    return text.starts_with('-') ? -0.0 : 0.0;
  }
  if (!whole || error != std::errc()) return NoNumber(word);
  if (!std::isfinite(number)) return Bad(fmt::format("{} is not a finite number", Quoted(word)));
  return number;
}

Result<std::int64_t> ParseWhole(std::string_view word) {
  const std::string_view text = WithoutPlus(word);
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool whole = end == text.data() + text.size() && !text.empty();
  if (whole && error == std::errc::result_out_of_range) {
    return Bad(fmt::format("{} is too large for a number", Quoted(word)));
  }
  if (!whole || error != std::errc()) {
    return Bad(fmt::format("{} is not a whole number", Quoted(word)));
  }
  return number;
}

}  // namespace arap
