#include "core/files/json_text.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "core/files/text_file.h"

namespace arap {
namespace {

std::string PlaceName(std::string_view text, const std::string& name, std::size_t offset) {
  const TextPlace place = PlaceAt(text, offset);
  return fmt::format("{}:{}:{}", name, place.line, place.column);
}

// Keeps nothing but the first thing that is wrong.
class Critic final : public nlohmann::json_sax<JsonValue> {
 public:
  std::size_t read = 0;  // bytes, with the one that is wrong
  std::string what;

  bool null() override { return true; }
  bool boolean(bool /*value*/) override { return true; }
  bool number_integer(number_integer_t /*value*/) override { return true; }
  bool number_unsigned(number_unsigned_t /*value*/) override { return true; }
  bool number_float(number_float_t /*value*/, const string_t& /*text*/) override { return true; }
  bool string(string_t& /*value*/) override { return true; }
  bool binary(binary_t& /*value*/) override { return true; }
  bool start_object(std::size_t /*size*/) override { return true; }
  bool key(string_t& /*value*/) override { return true; }
  bool end_object() override { return true; }
  bool start_array(std::size_t /*size*/) override { return true; }
  bool end_array() override { return true; }
  bool parse_error(std::size_t position, const std::string& /*token*/,
                   const nlohmann::detail::exception& error) override {
    read = position;
    what = error.what();
    // "[json.exception.…] parse error at line 1, column 7: syntax error while parsing … - what it is"
    for (const std::string_view before : {"] ", "column ", ": ", " - "}) {
      const std::size_t at = what.find(before);
      if (at != std::string::npos) what.erase(0, at + before.size());
    }
    // What was read last can be a whole file.
    if (const std::size_t last = what.find("; last read: "); last != std::string::npos) {
      const std::size_t expected = what.find("; expected", last);
      what.erase(last, expected == std::string::npos ? expected : expected - last);
    }
    return false;
  }
};

// Goes through a text that is known to be JSON.
class Walker {
 public:
  explicit Walker(std::string_view text) : text_(text) { SkipSpace(); }

  std::size_t at() const { return at_; }

  // From the start of a value to that of a value in it; false when there is none, and it stays.
  bool Enter(const JsonStep& step) {
    const std::string_view* const key = std::get_if<std::string_view>(&step);
    if (at_ >= text_.size() || text_[at_] != (key != nullptr ? '{' : '[')) return false;
    const std::size_t start = at_;
    std::optional<std::size_t> found;
    std::size_t index = 0;
    for (Next(); at_ < text_.size() && text_[at_] != '}' && text_[at_] != ']'; ++index) {
      bool wanted = false;
      if (key == nullptr) {
        wanted = index == std::get<std::size_t>(step);
      } else {
        const std::size_t name = at_;
        SkipValue();
        // A key that is there again replaces the one before.
        wanted = text_.substr(name + 1, at_ - name - 2) == *key;
        SkipSpace();
        Next();  // the colon
      }
      if (wanted) found = at_;
      if (wanted && key == nullptr) break;
      SkipValue();
      SkipSpace();
      if (at_ < text_.size() && text_[at_] == ',') Next();
    }
    at_ = found.value_or(start);
    return found.has_value();
  }

 private:
  void SkipSpace() { at_ = std::min(text_.find_first_not_of(" \t\r\n", at_), text_.size()); }

  // Over one character and the space behind it.
  void Next() {
    ++at_;
    SkipSpace();
  }

  void SkipString() {
    for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_) {
      if (text_[at_] == '\\') ++at_;
    }
    ++at_;
  }

  // To the end of the value that begins here.
  void SkipValue() {
    std::size_t depth = 0;
    do {
      const char c = at_ < text_.size() ? text_[at_] : ' ';
      if (c == '"') {
        SkipString();
      } else if (c == '{' || c == '[') {
        ++depth;
        ++at_;
      } else if (c == '}' || c == ']') {
        --depth;
        ++at_;
      } else if (depth > 0) {
        ++at_;
      } else {
        at_ = text_.find_first_of(",]} \t\r\n", at_);
      }
    } while (depth > 0 && at_ < text_.size());
    at_ = std::min(at_, text_.size());
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

constexpr std::size_t kDeepest = 100;  // lists and objects in one another

// The place from which on a text is too much to be kept as values, and what it has too much of.
struct Excess {
  std::size_t at = 0;
  std::string_view what;
};

// Found without keeping anything. A value of a character or two takes many times its length, and a
// text may be full of these. What is no JSON may count wrongly.
std::optional<Excess> FindExcess(std::string_view text, std::size_t per_byte) {
  // Bytes as the library has them, with what its lists grow ahead; a string may name a member.
  constexpr std::size_t kElement = 24, kList = 48, kObject = 64, kString = 96;
  const std::size_t most = (std::size_t{24} << 20U) + per_byte * text.size();
  std::size_t depth = 0, bytes = 0;
  bool quoted = false;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    if (quoted) {
      if (c == '\\') ++at;
      quoted = c != '"';
      ++bytes;
    } else if (c == '"') {
      quoted = true;
      bytes += kString;
    } else if (c == ',') {
      bytes += kElement;
    } else if (c == '[' || c == '{') {
      if (++depth > kDeepest) return Excess{at, "lists and objects are nested too deeply"};
      bytes += kElement + (c == '[' ? kList : kObject);
    } else if (depth > 0 && (c == ']' || c == '}')) {
      --depth;
    }
    if (bytes > most) {
      return Excess{at, "so many short values take too much memory for a text of this size"};
    }
  }
  return std::nullopt;
}

}  // namespace

Result<JsonValue> ParseJson(std::string_view text, const std::string& name, std::size_t per_byte) {
  if (const auto excess = FindExcess(text, per_byte)) {
    return Fail(FaultKind::kInvalidOption,
                fmt::format("{}: {}", PlaceName(text, name, excess->at), excess->what));
  }
  auto json = JsonValue::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_discarded()) return json;
  Critic critic;
  JsonValue::sax_parse(text, &critic);
  const std::size_t offset = critic.read > 0 ? critic.read - 1 : 0;
  return Fail(FaultKind::kInvalidOption,
              fmt::format("{}: not JSON: {}", PlaceName(text, name, offset), critic.what));
}

std::string JsonPlace(std::string_view text, const std::string& name,
                      const std::vector<JsonStep>& steps) {
  Walker walker(text);
  for (const JsonStep& step : steps) {
    if (!walker.Enter(step)) break;
  }
  return PlaceName(text, name, walker.at());
}

}  // namespace arap
