#include "client/cli/commands/flatten_inputs.h"

#include <charconv>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/try.h"
#include "core/files/json_text.h"
#include "core/files/text_scan.h"

namespace arap::cli {
namespace {

using Json = nlohmann::ordered_json;
using Words = std::vector<std::string>;
using Edges = std::vector<std::array<std::uint32_t, 2>>;

auto Bad(std::string message) { return Fail(FaultKind::kInvalidOption, std::move(message)); }

// The whole word as a number.
template <class Number>
std::optional<Number> ParseNumber(std::string_view word) {
  Number number{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return number;
}

std::optional<double> ParseFinite(std::string_view word) {
  const std::optional<double> number = ParseNumber<double>(word);
  return number && std::isfinite(*number) ? number : std::nullopt;
}

// A vertex that counts from 1.
Result<std::uint32_t> ParseVertex(const std::string& word, std::size_t vertex_count) {
  const auto number = ParseNumber<std::int64_t>(word);
  if (!number) return Bad(fmt::format("'{}' is not the number of a vertex", word));
  if (*number < 1) return Bad(fmt::format("vertex {}: vertices count from 1", *number));
  if (static_cast<std::uint64_t>(*number) > vertex_count) {
    return Bad(fmt::format("vertex {}: the surface has {}", *number, vertex_count));
  }
  return static_cast<std::uint32_t>(*number - 1);
}

auto NotFinite(const std::string& word) {
  return Bad(fmt::format("'{}' is not a finite number{}", word,
                         word.find(',') == std::string::npos ? "" : "; decimal comma?"));
}

// Calls `read` with the number and the words of every line that has any.
Status ReadLines(std::string_view text,
                 const std::function<Status(std::size_t number, const Words& words)>& read) {
  TextScanner scanner(text);
  do {
    Words words;
    for (auto word = scanner.Word(); !word.empty(); word = scanner.Word()) words.emplace_back(word);
    if (!words.empty()) CHECK_OK(read(scanner.line(), words));
  } while (scanner.NextLine());
  return {};
}

// The same with the words alone; the fault of `read` gets the number of the line.
Status ReadLines(std::string_view text, const std::string& name,
                 const std::function<Status(const Words&)>& read) {
  return ReadLines(text, [&](std::size_t number, const Words& words) -> Status {
    const Status good = read(words);
    if (good) return {};
    return Bad(fmt::format("{}:{}: {}", name, number, good.error().message));
  });
}

// The line with an entry, where a line of so many words has `entries` of them.
std::string PlaceOfEntry(std::string_view text, const std::string& name, std::size_t entry,
                         std::size_t (*entries)(std::size_t words)) {
  std::size_t line = 0, before = 0;
  (void)ReadLines(text, [&](std::size_t number, const Words& words) -> Status {
    if (line == 0 && entry < before + entries(words.size())) line = number;
    before += entries(words.size());
    return {};
  });
  return fmt::format("{}:{}", name, line);
}

std::size_t One(std::size_t /*words*/) { return 1; }

bool IsJson(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && (text[first] == '[' || text[first] == '{');
}

// An element of the list, which is all of the text or in "cut_edges".
std::string PlaceOfElement(std::string_view text, const std::string& name, const Json& json,
                           std::size_t element) {
  return json.is_object() ? JsonPlace(text, name, {"cut_edges", element})
                          : JsonPlace(text, name, {element});
}

Result<Edges> ParseJsonSeams(const std::string& text, const std::string& name,
                             std::size_t vertex_count) {
  TRY(const Json json, ParseJson(text, name));
  const auto cut_edges = json.is_object() ? json.find("cut_edges") : json.end();
  const Json& list = cut_edges != json.end() ? *cut_edges : json;
  if (!list.is_array()) return Bad(name + ": neither a list of edges nor one in \"cut_edges\"");
  const bool pairs = !list.empty() && list.front().is_array();
  if (!pairs && list.size() % 2 != 0) {
    return Bad(fmt::format("{}: {} vertices do not make pairs", name, list.size()));
  }
  std::vector<std::uint32_t> seams;
  std::string fault;
  const auto add = [&](const Json& vertex) {
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
      for (const Json& vertex : list[i]) add(vertex);
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
  TRY(const Json json, ParseJson(text, name));
  if (!json.is_array()) return Bad(name + ": not an array of numbers");
  std::vector<double> rigidity;
  for (const Json& element : json) {
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
  CHECK_OK(ReadLines(text, name, [&](const Words& words) -> Status {
    if (words.size() > 1) {
      return Bad(fmt::format("a line has one rigidity, these are {} words", words.size()));
    }
    const std::optional<double> number = ParseFinite(words[0]);
    if (!number) return NotFinite(words[0]);
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
  CHECK_OK(ReadLines(text, name, [&](const Words& words) -> Status {
    if (words.size() < 2) return Bad("a seam goes from one vertex to another");
    std::optional<std::uint32_t> last;
    for (const std::string& word : words) {
      TRY(const std::uint32_t vertex, ParseVertex(word, vertex_count));
      if (last) seams.push_back({*last, vertex});
      last = vertex;
    }
    return {};
  }));
  return seams;
}

Result<std::vector<UvPin>> ParsePins(const std::string& text, const std::string& name,
                                     std::size_t vertex_count) {
  std::vector<UvPin> pins;
  CHECK_OK(ReadLines(text, name, [&](const Words& words) -> Status {
    if (words.size() < 3 || words.size() > 4) {
      return Bad(fmt::format("a pin is 'vertex u v [weight]', these are {} words", words.size()));
    }
    UvPin pin;
    TRY(pin.vertex, ParseVertex(words[0], vertex_count));
    std::array<double, 3> numbers{};
    for (std::size_t i = 1; i < words.size(); ++i) {
      const std::optional<double> number = ParseFinite(words[i]);
      if (!number) return NotFinite(words[i]);
      numbers[i - 1] = *number;
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
  const Result<Json> json = ParseJson(text, name);
  if (!json) return name;
  const Json& list = json->is_object() ? json->at("cut_edges") : *json;
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
  Words words;
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
    const std::optional<double> angle = ParseFinite(words[2]);
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
