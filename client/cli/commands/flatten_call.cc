#include "client/cli/commands/flatten_call.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <future>
#include <span>
#include <stop_token>
#include <vector>

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

bool Below(std::span<const std::uint32_t> indices, std::size_t count) {
  return std::all_of(indices.begin(), indices.end(),
                     [count](std::uint32_t i) { return i < count; });
}

template <std::size_t kCount>
bool AllBelow(const std::vector<std::array<std::uint32_t, kCount>>& groups, std::size_t count) {
  return std::all_of(groups.begin(), groups.end(),
                     [count](const auto& group) { return Below(group, count); });
}

}  // namespace

Status CheckAnswer(const SurfaceMesh& mesh, const Flattening& flat) {
  const std::size_t positions = flat.uv.size();
  const std::size_t vertices = mesh.vertices.size(), triangles = mesh.triangles.size();
  bool good = flat.source.size() == positions && flat.corner_uv.size() == triangles;
  good = good && flat.singular_values.size() == triangles;
  good = good && flat.triangle_chart.size() == triangles;
  good = good && AllBelow(flat.corner_uv, positions) && Below(flat.source, vertices);
  good = good && AllBelow(flat.cuts, vertices);
  for (const FlatChart& chart : flat.charts) {
    for (const auto& loop : chart.loops) good = good && Below(loop, positions);
    good = good && Below(chart.anchors, positions);
  }
  if (good) return {};
  return Fail(FaultKind::kInternal, "The server's answer does not fit the mesh.");
}

Result<client::FlatSurface> FlattenWaiting(const client::Client& client, const SurfaceMesh& mesh,
                                           client::FlattenQuery query,
                                           std::optional<std::chrono::milliseconds> timeout,
                                           const std::string& what) {
  query.float64 = true;
  query.singular_values = true;
  std::stop_source stop;
  const Interrupt interrupt;
  Elapsed elapsed(what);
  // The future joins the call when it goes.
  std::future<Result<client::FlatSurface>> future = std::async(std::launch::async, [&] {
    return client.Flatten(mesh, query, {timeout, stop.get_token()});
  });
  constexpr std::chrono::milliseconds kLook{100};
  while (future.wait_for(kLook) != std::future_status::ready) {
    if (interrupt.happened()) stop.request_stop();
    elapsed.Show();
  }
  elapsed.Clear();
  TRY(client::FlatSurface answer, future.get());
  CHECK_OK(CheckAnswer(mesh, answer.flat));
  return answer;
}

}  // namespace arap::cli
