#include "client/cli/commands/flatten_inputs.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <sstream>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/try.h"
#include "core/files/json_text.h"
#include "core/files/text_scan.h"

namespace arap::cli {
namespace {

using Edges = std::vector<std::array<std::uint32_t, 2>>;

auto Bad(std::string message) { return Fail(FaultKind::kInvalidOption, std::move(message)); }

// A vertex that counts from 1.
Result<std::uint32_t> ParseVertex(std::string_view word, std::size_t vertex_count) {
  TRY(const std::int64_t number, ParseWhole(word));
  if (number < 1) return Bad(fmt::format("vertex {}: vertices count from 1", number));
  if (static_cast<std::uint64_t>(number) > vertex_count) {
    return Bad(fmt::format("vertex {}: the surface has {}", number, vertex_count));
  }
  return static_cast<std::uint32_t>(number - 1);
}

// A line of a text: its words, one after the other, since there may be any number of them.
class Line {
 public:
  Line(std::string_view first, TextScanner& scanner) : word_(first), scanner_(scanner) {}

  // Empty behind the last one.
  std::string_view word() const { return word_; }
  void Next() { word_ = scanner_.Word(); }
  // How many there are from this one on. Goes to the end.
  std::size_t Count() {
    std::size_t count = 0;
    for (; !word_.empty(); Next()) ++count;
    return count;
  }

 private:
  std::string_view word_;
  TextScanner& scanner_;
};

// Calls `read` with the number of every line that has words, and with these.
Status ReadLines(std::string_view text,
                 const std::function<Status(std::size_t number, Line& line)>& read) {
  TextScanner scanner(text);
  do {
    Line line(scanner.Word(), scanner);
    if (!line.word().empty()) CHECK_OK(read(scanner.line(), line));
  } while (scanner.NextLine());
  return {};
}

// The same with the line alone; the fault of `read` gets its number.
Status ReadLines(std::string_view text, const std::string& name,
                 const std::function<Status(Line& line)>& read) {
  CHECK_OK(CheckText(text, name));
  return ReadLines(text, [&](std::size_t number, Line& line) -> Status {
    const Status good = read(line);
    return good ? Status() : FailAt(name, number, good.error().message);
  });
}

// The line with an entry, where a line of so many words has `entries` of them.
std::string PlaceOfEntry(std::string_view text, const std::string& name, std::size_t entry,
                         std::size_t (*entries)(std::size_t words)) {
  std::size_t found = 0, before = 0;
  (void)ReadLines(text, [&](std::size_t number, Line& line) -> Status {
    const std::size_t after = before + entries(line.Count());
    if (found == 0 && entry < after) found = number;
    before = after;
    return {};
  });
  return fmt::format("{}:{}", name, found);
}

std::size_t One(std::size_t /*words*/) { return 1; }

bool IsJson(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && (text[first] == '[' || text[first] == '{');
}

// An element of the list, which is all of the text or in "cut_edges".
std::string PlaceOfElement(std::string_view text, const std::string& name, const JsonValue& json,
                           std::size_t element) {
  return json.is_object() ? JsonPlace(text, name, {"cut_edges", element})
                          : JsonPlace(text, name, {element});
}

Result<Edges> ParseJsonSeams(const std::string& text, const std::string& name,
                             std::size_t vertex_count) {
  TRY(const JsonValue json, ParseJson(text, name));
  const auto cut_edges = json.is_object() ? json.find("cut_edges") : json.end();
  const JsonValue& list = cut_edges != json.end() ? *cut_edges : json;
  if (!list.is_array()) return Bad(name + ": neither a list of edges nor one in \"cut_edges\"");
  const bool pairs = !list.empty() && list.front().is_array();
  if (!pairs && list.size() % 2 != 0) {
    return Bad(fmt::format("{}: {} vertices do not make pairs", name, list.size()));
  }
  std::vector<std::uint32_t> seams;
  seams.reserve(pairs ? 2 * list.size() : list.size());
  std::string fault;
  const auto add = [&](const JsonValue& vertex) {
    if (!vertex.is_number_unsigned() || vertex.get<std::uint64_t>() >= vertex_count) {
      if (fault.empty()) {
        fault = fmt::format("{} is not a vertex: they go from 0 to {}", vertex.dump(),
                            vertex_count - 1);
      }
      return;
    }
    seams.push_back(vertex.get<std::uint32_t>());
  };
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!pairs) {
      add(list[i]);
    } else if (list[i].is_array() && list[i].size() == 2) {
      for (const JsonValue& vertex : list[i]) add(vertex);
    } else {
      fault = list[i].dump() + " is not a pair of vertices";
    }
    if (!fault.empty()) {
      return Bad(fmt::format("{}: element {}: {}", PlaceOfElement(text, name, json, i), i, fault));
    }
  }
  Edges edges(seams.size() / 2);
  for (std::size_t i = 0; i < edges.size(); ++i) edges[i] = {seams[2 * i], seams[2 * i + 1]};
  return edges;
}

Status CheckRigidity(double rigidity) {
  if (rigidity > 0 && rigidity <= kMaxRigidity) return {};
  return Bad(fmt::format("a rigidity of {} is not above 0 and at most {}", rigidity, kMaxRigidity));
}

Result<std::vector<double>> ParseJsonRigidity(const std::string& text, const std::string& name) {
  TRY(const JsonValue json, ParseJson(text, name));
  if (!json.is_array()) return Bad(name + ": not an array of numbers");
  std::vector<double> rigidity;
  rigidity.reserve(json.size());
  for (const JsonValue& element : json) {
    const Status good = element.is_number() ? CheckRigidity(element.get<double>())
                                            : Bad(element.dump() + " is not a number");
    if (!good) {
      const std::size_t i = rigidity.size();
      return Bad(
          fmt::format("{}: element {}: {}", JsonPlace(text, name, {i}), i, good.error().message));
    }
    rigidity.push_back(element.get<double>());
  }
  return rigidity;
}

Result<std::vector<double>> ParseRigidityLines(const std::string& text, const std::string& name) {
  std::vector<double> rigidity;
  CHECK_OK(ReadLines(text, name, [&](Line& line) -> Status {
    const Result<double> number = ParseNumber(line.word());
    if (const std::size_t words = line.Count(); words > 1) {
      return Bad(fmt::format("a line has one rigidity, these are {} words", words));
    }
    if (!number) return Fail(number.error());
    rigidity.push_back(*number);
    return CheckRigidity(*number);
  }));
  return rigidity;
}

}  // namespace

Result<Edges> ParseSeams(const std::string& text, const std::string& name,
                         std::size_t vertex_count) {
  if (IsJson(text)) return ParseJsonSeams(text, name, vertex_count);
  Edges seams;
  CHECK_OK(ReadLines(text, name, [&](Line& line) -> Status {
    TRY(std::uint32_t last, ParseVertex(line.word(), vertex_count));
    line.Next();
    if (line.word().empty()) return Bad("a seam goes from one vertex to another");
    for (; !line.word().empty(); line.Next()) {
      TRY(const std::uint32_t vertex, ParseVertex(line.word(), vertex_count));
      seams.push_back({last, vertex});
      last = vertex;
    }
    return {};
  }));
  return seams;
}

Result<std::vector<UvPin>> ParsePins(const std::string& text, const std::string& name,
                                     std::size_t vertex_count) {
  std::vector<UvPin> pins;
  CHECK_OK(ReadLines(text, name, [&](Line& line) -> Status {
    std::array<std::string_view, 4> words;
    std::size_t count = 0;
    for (; count < words.size() && !line.word().empty(); line.Next()) words[count++] = line.word();
    count += line.Count();
    if (count < 3 || count > words.size()) {
      return Bad(fmt::format("a pin is 'vertex u v [weight]', these are {} words", count));
    }
    UvPin pin;
    TRY(pin.vertex, ParseVertex(words[0], vertex_count));
    std::array<double, 3> numbers{};
    for (std::size_t i = 1; i < count; ++i) {
      TRY(numbers[i - 1], ParseNumber(words[i]));
    }
    pin.uv = {numbers[0], numbers[1]};
    pin.weight = numbers[2];
    if (pin.weight < 0) return Bad("a weight is not negative; 0 or none holds exactly");
    pins.push_back(pin);
    return {};
  }));
  return pins;
}

Result<std::vector<double>> ParseRigidity(const std::string& text, const std::string& name,
                                          std::size_t triangle_count) {
  auto rigidity = IsJson(text) ? ParseJsonRigidity(text, name) : ParseRigidityLines(text, name);
  if (rigidity && rigidity->size() != triangle_count) {
    return Bad(fmt::format("{}: {} numbers; the surface has {} triangles, and each needs one", name,
                           rigidity->size(), triangle_count));
  }
  return rigidity;
}

std::string PlaceOfSeam(const std::string& text, const std::string& name, std::size_t edge) {
  if (!IsJson(text)) {
    return PlaceOfEntry(text, name, edge, [](std::size_t words) { return words - 1; });
  }
  const Result<JsonValue> json = ParseJson(text, name);
  if (!json) return name;
  const JsonValue& list = json->is_object() ? json->at("cut_edges") : *json;
  const bool pairs = list.front().is_array();
  return PlaceOfElement(text, name, *json, pairs ? edge : 2 * edge);
}

std::string PlaceOfPin(const std::string& text, const std::string& name, std::size_t pin) {
  return PlaceOfEntry(text, name, pin, &One);
}

std::string PlaceOfRigidity(const std::string& text, const std::string& name,
                            std::size_t triangle) {
  return IsJson(text) ? JsonPlace(text, name, {triangle})
                      : PlaceOfEntry(text, name, triangle, &One);
}

std::uint32_t FirstVertexIn(const std::string& text) { return IsJson(text) ? 0 : 1; }

Result<GrainLine> ParseGrain(const std::string& text) {
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, ',');) words.push_back(std::move(word));
  if (words.size() < 2 || words.size() > 3 || text.ends_with(',')) {
    return Bad(fmt::format("'{}' is not FROM,TO or FROM,TO,ANGLE", text));
  }
  GrainLine line;
  std::uint32_t* const ends[] = {&line.from, &line.to};
  for (std::size_t i = 0; i < 2; ++i) {
    TRY(*ends[i], ParseVertex(words[i], UINT32_MAX));
  }
  if (words.size() == 3) {
    const Result<double> angle = ParseNumber(words[2]);
    if (!angle) return Bad(fmt::format("'{}' is not an angle in degrees", words[2]));
    // Whole turns do not count, and what is left is exact.
    line.angle = std::fmod(*angle, 360.0) * (std::numbers::pi / 180);
  }
  return line;
}

Status CheckGrain(const GrainLine& line, std::size_t vertex_count) {
  for (const std::uint32_t vertex : {line.from, line.to}) {
    if (vertex < vertex_count) continue;
    return Bad(fmt::format("--grain: vertex {}: the surface has {}", std::uint64_t{vertex} + 1,
                           vertex_count));
  }
  return {};
}

}  // namespace arap::cli
