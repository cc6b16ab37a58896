#include "core/flatten/layout/wishes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "core/base/try.h"

namespace arap {
namespace {

// Part of a chart's diagonal below which two places are one.
constexpr double kOnePlace = 1e-9;

Fault Wrong(FaultKind kind, const char* list, std::size_t entry, const char* member,
            std::string message) {
  return Fault(kind, std::move(message)).Field(fmt::format("{}[{}]{}", list, entry, member));
}

class Finder {
 public:
  Finder(const std::vector<Chart>& charts, std::span<const std::uint32_t> source,
         std::size_t input_vertices, const FlattenOptions& options, const CancelToken& cancel)
      : charts_(charts),
        source_(source),
        input_vertices_(input_vertices),
        options_(options),
        cancel_(cancel),
        wishes_(charts.size()) {}

  Result<std::vector<Wishes>> Find() {
    if (options_.pins.empty() && options_.grain_lines.empty()) return std::move(wishes_);
    CHECK_OK(CheckPins());
    FindPlaces();
    for (std::size_t i = 0; i < options_.pins.size(); ++i) CHECK_OK(AddPin(i));
    CHECK_OK(CheckSpread());
    for (Wishes& wishes : wishes_) {
      std::sort(wishes.pins.begin(), wishes.pins.end(),
                [](const HeldVertex& a, const HeldVertex& b) { return a.vertex < b.vertex; });
    }
    for (std::size_t i = 0; i < options_.grain_lines.size(); ++i) CHECK_OK(AddGrainLine(i));
    return std::move(wishes_);
  }

 private:
  // A vertex of a chart.
  struct Place {
    std::uint32_t input, chart, vertex;
  };

  Status CheckVertex(std::uint32_t vertex, const char* list, std::size_t i, const char* member) {
    if (vertex < input_vertices_) return {};
    Fault fault = Wrong(
        FaultKind::kIndexOutOfRange, list, i, member,
        fmt::format("{}[{}] names vertex {}; the mesh has {}.", list, i, vertex, input_vertices_));
    fault.Element(vertex).Detail("limit", fmt::to_string(input_vertices_));
    return Fail(std::move(fault));
  }

  Status CheckPins() {
    const double farthest = kMaxPinDistance * Largest();
    std::vector<bool> pinned(input_vertices_);
    for (std::size_t i = 0; i < options_.pins.size(); ++i) {
      const UvPin& pin = options_.pins[i];
      CHECK_OK(CheckVertex(pin.vertex, "pins", i, ".vertex"));
      if (std::abs(pin.uv) > farthest) {
        return Fail(
            Wrong(FaultKind::kInvalidOption, "pins", i, "",
                  fmt::format("pins[{}] is {:g} away from 0; at most {:g} times the size of "
                              "the surface is allowed.",
                              i, std::abs(pin.uv), kMaxPinDistance))
                .Element(pin.vertex)
                .Detail("limit", fmt::format("{:g}", farthest)));
      }
      if (pinned[pin.vertex]) {
        return Fail(Wrong(FaultKind::kInvalidOption, "pins", i, ".vertex",
                          fmt::format("Vertex {} is pinned twice.", pin.vertex))
                        .Element(pin.vertex));
      }
      pinned[pin.vertex] = true;
    }
    return {};
  }

  // Diagonal of the largest chart.
  double Largest() const {
    double largest = 0;
    for (const Chart& chart : charts_) {
      largest = std::max(largest, chart.diagonal);
    }
    return largest;
  }

  // The places of the vertices that are named, by input vertex, chart and copy.
  void FindPlaces() {
    std::vector<bool> named(input_vertices_);
    for (const UvPin& pin : options_.pins) named[pin.vertex] = true;
    for (const GrainLine& line : options_.grain_lines) {
      for (const std::uint32_t v : {line.from, line.to}) {
        if (v < named.size()) named[v] = true;
      }
    }
    for (std::uint32_t c = 0; c < charts_.size(); ++c) {
      for (std::uint32_t v = 0; v < charts_[c].vertices.size(); ++v) {
        const std::uint32_t input = source_[charts_[c].vertices[v]];
        if (named[input]) places_.push_back({input, c, v});
      }
    }
    std::stable_sort(places_.begin(), places_.end(),
                     [](const Place& a, const Place& b) { return a.input < b.input; });
  }

  // On all charts, by chart.
  std::span<const Place> PlacesOf(std::uint32_t input) const {
    const auto at =
        std::equal_range(places_.begin(), places_.end(), Place{input, 0, 0},
                         [](const Place& a, const Place& b) { return a.input < b.input; });
    return {at.first, at.second};
  }

  std::span<const Place> PlacesOf(std::uint32_t input, std::uint32_t chart) const {
    const auto at = std::equal_range(
        places_.begin(), places_.end(), Place{input, chart, 0}, [](const Place& a, const Place& b) {
          return a.input != b.input ? a.input < b.input : a.chart < b.chart;
        });
    return {at.first, at.second};
  }

  // Asks the caller now and then: there can be many wishes and charts.
  Status Ask() {
    if (++steps_ % 1024 != 0) return {};
    return cancel_.Check();
  }

  Status AddPin(std::size_t i) {
    CHECK_OK(Ask());
    const UvPin& pin = options_.pins[i];
    const auto places = PlacesOf(pin.vertex);
    if (places.empty()) {
      return Fail(
          Wrong(FaultKind::kInvalidOption, "pins", i, ".vertex",
                fmt::format("Vertex {} is in no triangle and cannot be pinned.", pin.vertex))
              .Element(pin.vertex));
    }
    std::uint32_t last = kNone;
    for (const Place& place : places) {
      if (place.chart == last) continue;  // another copy across a cut
      last = place.chart;
      wishes_[place.chart].pins.push_back({place.vertex, pin.uv, pin.weight});
    }
    return {};
  }

  // Several pins on one spot would shrink the layout to a point.
  Status CheckSpread() {
    for (std::size_t c = 0; c < wishes_.size(); ++c) {
      const auto& pins = wishes_[c].pins;
      if (pins.size() < 2) continue;
      const Chart& chart = charts_[c];
      bool spread = false;
      for (const HeldVertex& pin : pins) {
        spread = spread || std::abs(pin.uv - pins.front().uv) > kOnePlace * chart.diagonal;
      }
      if (spread) continue;
      return Fail(Fault(FaultKind::kInvalidOption,
                        fmt::format("All {} pins of a chart are at one place.", pins.size()))
                      .Field("pins")
                      .Element(source_[chart.vertices[pins.front().vertex]]));
    }
    return {};
  }

  Status AddGrainLine(std::size_t i) {
    const GrainLine& line = options_.grain_lines[i];
    CHECK_OK(CheckVertex(line.from, "grain_lines", i, ".from_vertex"));
    CHECK_OK(CheckVertex(line.to, "grain_lines", i, ".to_vertex"));
    const auto wrong = [&](std::string message) {
      return Fail(Wrong(FaultKind::kInvalidOption, "grain_lines", i, "", std::move(message))
                      .Element(line.from)
                      .Element(line.to));
    };
    if (line.from == line.to) return wrong("A grain line needs two vertices.");
    // By chart, from the end with fewer places; what an earlier line with these ends passed over is
    // passed over again.
    auto [one, other] = std::minmax({line.from, line.to});
    std::size_t& next = next_place_[{one, other}];
    if (PlacesOf(other).size() < PlacesOf(one).size()) std::swap(one, other);
    const auto places = PlacesOf(one);
    bool shared = next > 0;
    std::uint32_t last = kNone;
    for (; next < places.size(); ++next) {
      const Place& at = places[next];
      CHECK_OK(Ask());
      if (at.chart == last) continue;
      last = at.chart;
      if (PlacesOf(other, last).empty()) continue;
      shared = true;
      Wishes& wishes = wishes_[last];
      if (wishes.grain || wishes.pinned()) continue;
      const auto ends = NearestEnds(last, line);
      wishes.grain = {ends[0], ends[1], line.angle};
      return {};
    }
    return wrong(
        shared ? fmt::format("The chart of grain_lines[{}] has one already, or several pins.", i)
               : fmt::format("Vertices {} and {} are on no common chart.", line.from, line.to));
  }

  // The copies of the ends on one chart that has both; along a cut those that are the fewest steps
  // apart on the boundary, which are on one side of it. O(boundary).
  std::array<std::uint32_t, 2> NearestEnds(std::uint32_t chart, const GrainLine& line) const {
    const auto from = PlacesOf(line.from, chart), to = PlacesOf(line.to, chart);
    std::array<std::uint32_t, 2> best{from.front().vertex, to.front().vertex};
    if (from.size() * to.size() == 1) return best;
    const Chart& own = charts_[chart];
    std::size_t least = std::numeric_limits<std::size_t>::max();
    for (const auto& loop : own.loops) {
      // Twice round, so that an end meets the last one of the other kind across the start as well.
      const std::size_t n = loop.size();
      std::size_t seen_from = 0, seen_to = 0;  // places, from 1
      for (std::size_t k = 1; k <= 2 * n; ++k) {
        const std::uint32_t input = source_[own.vertices[loop[(k - 1) % n]]];
        if (input != line.from && input != line.to) continue;
        (input == line.from ? seen_from : seen_to) = k;
        if (seen_from == 0 || seen_to == 0) continue;
        const std::size_t steps = std::max(seen_from, seen_to) - std::min(seen_from, seen_to);
        if (steps >= least) continue;
        least = steps;
        best = {loop[(seen_from - 1) % n], loop[(seen_to - 1) % n]};
      }
    }
    return best;
  }

  const std::vector<Chart>& charts_;
  const std::span<const std::uint32_t> source_;
  const std::size_t input_vertices_;
  const FlattenOptions& options_;
  const CancelToken& cancel_;
  std::size_t steps_ = 0;
  std::vector<Wishes> wishes_;
  std::vector<Place> places_;
  // By the ends of grain lines, the lower first: before it all places were passed over.
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> next_place_;
};

}  // namespace

Result<std::vector<Wishes>> FindWishes(const std::vector<Chart>& charts,
                                       std::span<const std::uint32_t> source,
                                       std::size_t input_vertices, const FlattenOptions& options,
                                       const CancelToken& cancel) {
  return Finder(charts, source, input_vertices, options, cancel).Find();
}

}  // namespace arap
