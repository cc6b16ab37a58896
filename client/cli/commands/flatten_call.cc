#include "client/cli/commands/flatten_call.h"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <future>
#include <span>
#include <stop_token>

#include <fmt/format.h>

#include "client/cli/report.h"
#include "core/base/try.h"

namespace arap::cli {
namespace {

// A signal handler has nothing else to speak to.
// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables)
std::atomic<bool> interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free);

// While one of these is there, the first SIGINT is only noted; the next ends the program. One at a
// time.
class Interrupt {
 public:
  Interrupt() {
    interrupted = false;
    struct sigaction note {};
    note.sa_handler = [](int) { interrupted = true; };
    note.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
    sigemptyset(&note.sa_mask);
    sigaction(SIGINT, &note, &before_);
  }
  ~Interrupt() { sigaction(SIGINT, &before_, nullptr); }
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  bool happened() const { return interrupted; }

 private:
  struct sigaction before_ {};
};

bool AllBelow(std::span<const std::uint32_t> indices, std::size_t count) {
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
  good =
      good && AllBelow(flat.corner_uv, positions) && AllBelow(flat.uv_vertex, mesh.vertex_count());
  good = good && AllBelow(flat.cut_edges, mesh.vertex_count());
  for (const client::FlatChart& chart : flat.charts) {
    for (const auto& loop : chart.loops) good = good && AllBelow(loop, positions);
  }
  if (good) return {};
  return Fail(FaultKind::kInternal, "The server's answer does not fit the mesh.");
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
  TRY(client::FlatSurface flat, answer.get());
  CHECK_OK(CheckAnswer(mesh, flat));
  return flat;
}

}  // namespace arap::cli
