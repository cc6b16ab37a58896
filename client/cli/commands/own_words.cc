#include "client/cli/commands/own_words.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace arap::cli {
namespace {

bool IsWord(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

// The number that a text begins with, which is cut off.
std::optional<std::uint32_t> TakeNumber(std::string_view& text) {
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

// A number as the file has it.
std::string Named(std::uint32_t number, bool triangle, const Counting& counting) {
  if (triangle && counting.face_of) return fmt::to_string(counting.face_of(number));
  return fmt::to_string(std::uint64_t{number} + counting.first);
}

std::vector<std::string> Named(std::span<const std::uint32_t> numbers, bool triangles,
                               const Counting& counting) {
  std::vector<std::string> names;
  for (const std::uint32_t number : numbers) names.push_back(Named(number, triangles, counting));
  return names;
}

// What these numbers count.
std::string_view NumbersName(bool triangles, const Counting& counting) {
  if (!triangles) return "vertices";
  if (!counting.face_of) return "triangles";
  return counting.lines ? "lines" : "faces";
}

// What sentences say before numbers. An edge is "3-7".
constexpr std::array<std::string_view, 5> kElements{"vertex", "vertices", "edge", "triangle",
                                                    "triangles"};
// And between them.
constexpr std::array<std::string_view, 4> kBetween{", and ", ", ", " and ", "-"};

// `rest` begins with the numbers that belong to `word`; they are cut off.
std::string NumbersOf(std::string_view word, std::string_view& rest, const Counting& counting) {
  const bool triangle = word.starts_with("triangle");
  std::string out;
  if (triangle && counting.face_of) {
    out = fmt::format("{}{} ", counting.lines ? "at line" : "of face",
                      word.ends_with('s') ? "s" : "");
  }
  while (const auto number = TakeNumber(rest)) {
    out += Named(*number, triangle, counting);
    for (const std::string_view between : kBetween) {
      std::string_view next = rest;
      if (!next.starts_with(between)) continue;
      next.remove_prefix(between.size());
      if (next.empty() || std::isdigit(static_cast<unsigned char>(next.front())) == 0) continue;
      out += between;
      rest = next;
      break;
    }
  }
  return out;
}

constexpr std::size_t kShownElements = 5;  // in a warning

// The options of a request that sentences name and that are flags here; no sentence has these words
// for anything else.
constexpr std::array<std::string_view, 8> kFlags{"auto_cut",
                                                 "split_non_manifold",
                                                 "tolerate_degenerate",
                                                 "refine_stop",
                                                 "surface_key",
                                                 "drop_duplicates",
                                                 "weld",
                                                 "stitch"};

std::string AsFlag(std::string_view option) {
  std::string flag = "--" + std::string(option);
  std::replace(flag.begin(), flag.end(), '_', '-');
  return flag;
}

// What the elements of a fault are.
std::string_view ElementsOf(const Fault& fault) {
  switch (fault.kind) {
    case FaultKind::kNonFiniteCoordinate:
    case FaultKind::kUnknownEdge:
    case FaultKind::kNonManifoldVertex:
      return "vertices";
    case FaultKind::kNotInjective:
      return fault.field == "pins" || !DetailOf(fault, "flipped").empty() ? "triangles"
                                                                          : "vertices";
    case FaultKind::kHandleOutside:
    case FaultKind::kDuplicateHandle:
    case FaultKind::kUnknownHandle:
    case FaultKind::kConflictingHandles:
    case FaultKind::kTooManyHandles:
      return "handles";
    default:
      return fault.field == "mesh.triangles" || fault.field == "energy.rigidity" ? "triangles"
                                                                                 : "vertices";
  }
}

void ReplaceAll(const std::string& what, std::string_view with, std::string& text) {
  for (std::size_t at = text.find(what); at != std::string::npos;
       at = text.find(what, at + with.size())) {
    text.replace(at, what.size(), with);
  }
}

}  // namespace

Counting CountingOf(const SurfaceFile& file) {
  Counting counting;
  counting.first = file.text.empty() ? 0 : 1;
  counting.lines = !file.face_lines.empty();
  counting.face_of = [&file](std::uint32_t triangle) -> std::size_t {
    return triangle < file.first_triangle.back() ? file.PlaceOf(file.FaceOf(triangle)) : 0;
  };
  return counting;
}

std::size_t EntryOf(std::string_view rest, std::size_t none) {
  if (!rest.starts_with('[')) return none;
  rest.remove_prefix(1);
  return TakeNumber(rest).value_or(none);
}

std::string InOwnWords(std::string_view sentence, const Counting& counting) {
  std::string out;
  while (!sentence.empty()) {
    const auto word_end = std::find_if_not(sentence.begin(), sentence.end(), IsWord);
    const std::string_view word =
        sentence.substr(0, static_cast<std::size_t>(word_end - sentence.begin()));
    if (word.empty()) {
      out += sentence.front();
      sentence.remove_prefix(1);
      continue;
    }
    sentence.remove_prefix(word.size());
    if (std::find(kFlags.begin(), kFlags.end(), word) != kFlags.end()) {
      out += AsFlag(word);
      continue;
    }
    out += word;
    std::string lower(word);
    lower.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(lower.front())));
    if (std::find(kElements.begin(), kElements.end(), lower) == kElements.end()) continue;
    const std::string_view space = sentence.starts_with(": ") ? ": " : " ";
    if (!sentence.starts_with(space) || sentence.size() == space.size() ||
        std::isdigit(static_cast<unsigned char>(sentence[space.size()])) == 0) {
      continue;
    }
    out += space;
    sentence.remove_prefix(space.size());
    out += NumbersOf(lower, sentence, counting);
  }
  return out;
}

Fault InOwnWords(Fault fault, const std::vector<Origin>& origins) {
  const auto origin = std::find_if(origins.begin(), origins.end(), [&](const Origin& each) {
    if (!fault.field.starts_with(each.field)) return false;
    const char next = (fault.field + ' ')[each.field.size()];
    return next == ' ' || next == '[' || next == '.';
  });
  if (origin == origins.end()) return fault;
  const std::string_view rest = std::string_view(fault.field).substr(origin->field.size());
  const std::size_t index_end = rest.find(']');
  const bool indexed = rest.starts_with('[') && index_end != std::string_view::npos;

  if (indexed) {
    // "frames[3]: what", "pins[3].weight is", "pins[3] is".
    const std::string entry = origin->field + std::string(rest.substr(0, index_end + 1));
    if (fault.message.starts_with(entry + ": ")) fault.message.erase(0, entry.size() + 2);
    ReplaceAll(entry + ".", "", fault.message);
    ReplaceAll(entry, origin->entry, fault.message);
  }
  fault.message = InOwnWords(fault.message, origin->counting);
  std::string place = origin->place(rest);
  if (!fault.elements.empty() && !indexed) {
    const std::string_view what = ElementsOf(fault);
    const bool triangles = what == "triangles", faces = triangles && origin->counting.face_of;
    const Counting counting = what == "handles" ? Counting() : origin->counting;
    const std::vector<std::string> names = Named(fault.elements, triangles, counting);
    fault.details.insert(fault.details.begin(),
                         {std::string(what == "handles" ? what : NumbersName(triangles, counting)),
                          fmt::format("{}", fmt::join(names, " "))});
    if (faces && origin->field == "mesh") {
      place += (counting.lines ? ":" : ": face ") + names.front();
    }
  }
  if (fault.message.find(place) == std::string::npos) {
    fault.message = fmt::format("{}: {}", place, fault.message);
  }
  for (auto& [name, value] : fault.details) {
    if (name == "vertex" || name == "edge" || name == "triangle") {
      value = InOwnWords(name + " " + value, origin->counting).substr(name.size() + 1);
    }
  }
  fault.elements.clear();
  fault.field.clear();
  return fault;
}

std::vector<Warning> InOwnWords(std::vector<Warning> warnings, const Counting& counting) {
  for (Warning& warning : warnings) {
    warning.message = InOwnWords(warning.message, counting);
    const bool triangles = warning.kind.ends_with("_triangles");
    const bool vertices = warning.kind.ends_with("_vertices") || warning.kind == "t_junctions";
    if (warning.elements.empty() || !(triangles || vertices)) continue;
    const auto shown =
        std::span(warning.elements).first(std::min(warning.elements.size(), kShownElements));
    warning.message += fmt::format(" ({} {}{})", NumbersName(triangles, counting),
                                   fmt::join(Named(shown, triangles, counting), " "),
                                   warning.count > shown.size() ? " …" : "");
  }
  return warnings;
}

}  // namespace arap::cli
