#include "core/cut/auto_cut.h"

#include "core/cut/cut_field.h"
#include "core/cut/cut_graph.h"
#include "core/cut/shorten.h"

namespace arap {

Result<std::vector<std::uint32_t>> CutToDisks(std::span<const Point3> input_vertices,
                                              const SplitVertices& split,
                                              std::span<const Chart> charts, Gluing& gluing,
                                              const CancelToken& cancel) {
  CutField field(input_vertices, split, gluing);
  CutGraph graph(field, cancel);
  CutShortener shortener(field, cancel);
  for (const Chart& chart : charts) {
    if (chart.disk()) continue;
    field.Measure(chart);
    const auto ends = graph.Draw(chart);
    if (!ends) return Fail(ends.error());
    if (auto ok = shortener.Shorten(chart, *ends); !ok) return Fail(std::move(ok.error()));
  }
  std::vector<std::uint32_t> cut;
  for (std::uint32_t side = 0; side < gluing.mate.size(); ++side) {
    if (field.Drawn(side) && side < gluing.mate[side]) cut.push_back(side);
  }
  return cut;
}

}  // namespace arap
