#include "client/cli/commands/flatten_call.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <future>
#include <span>
#include <stop_token>

#include <fmt/format.h>

#include "client/cli/interrupt.h"
#include "client/cli/report.h"

namespace arap::cli {
namespace {

bool Below(std::span<const std::uint32_t> indices, std::size_t count) {
  return std::all_of(indices.begin(), indices.end(),
                     [count](std::uint32_t i) { return i < count; });
}

}  // namespace

Status CheckAnswer(const client::SurfaceMesh& mesh, const client::FlatSurface& flat) {
  const std::size_t positions = flat.uv.size() / 2;
  bool good = flat.uv.size() % 2 == 0 && flat.uv_vertex.size() == positions;
  good = good && flat.corner_uv.size() == mesh.triangles.size();
  good = good && flat.singular_values.size() == 2 * mesh.triangle_count();
  good = good && flat.triangle_chart.size() == mesh.triangle_count();
  good = good && Below(flat.corner_uv, positions) && Below(flat.uv_vertex, mesh.vertex_count());
  good = good && Below(flat.cut_edges, mesh.vertex_count());
  for (const client::FlatChart& chart : flat.charts) {
    for (const auto& loop : chart.loops) good = good && Below(loop, positions);
  }
  if (good) return {};
  return Fail(FaultKind::kInternal, "the server's answer does not fit the mesh");
}

Result<client::FlatSurface> FlattenWaiting(const client::Client& client,
                                           const client::SurfaceMesh& mesh,
                                           client::FlattenOptions options,
                                           std::optional<std::chrono::milliseconds> timeout,
                                           const std::string& what) {
  options.float64 = true;
  options.singular_values = true;
  std::stop_source stop;
  const Interrupt interrupt;
  Elapsed elapsed(what);
  // The future joins the call when it goes.
  std::future<Result<client::FlatSurface>> answer = std::async(std::launch::async, [&] {
    return client.Flatten(mesh, options, {timeout, stop.get_token()});
  });
  constexpr std::chrono::milliseconds kLook{100};
  while (answer.wait_for(kLook) != std::future_status::ready) {
    if (interrupt.happened()) stop.request_stop();
    elapsed.Show();
  }
  elapsed.Clear();
  Result<client::FlatSurface> flat = answer.get();
  if (!flat) return flat;
  if (const Status good = CheckAnswer(mesh, *flat); !good) return Fail(good.error());
  return flat;
}

}  // namespace arap::cli
