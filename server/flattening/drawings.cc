#include "server/flattening/drawings.h"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/base/try.h"
#include "core/drawing/captions.h"
#include "core/drawing/draw.h"
#include "server/budget/faults.h"
#include "server/runtime/clock.h"

namespace arap::app {
namespace {

// What is done of the whole work when drawing begins and when it ends.
constexpr double kLayoutDone = 0.9, kDrawingDone = 0.97;

std::size_t BorderOf(const Flattening& flat) {
  std::size_t points = 0;
  for (const FlatChart& chart : flat.charts) {
    for (const auto& loop : chart.loops) points += loop.size();
  }
  return points;
}

}  // namespace

Result<Drawn> DrawAll(DerivedCache& derived, runtime::Metrics& metrics, const Caller& caller,
                      const DrawingOrder& order, const Flattening& flat, const CancelToken& cancel,
                      const FlattenProgress& progress) {
  Drawn drawn;
  if (order.drawings.empty()) return drawn;
  const runtime::WallTimer working;
  const std::vector<std::string> names = PieceNames(flat, order.parts);
  const std::size_t border = BorderOf(flat), count = order.drawings.size();
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const DrawingOptions& options = order.drawings[i];
    if (progress) {
      const double done = static_cast<double>(i) / static_cast<double>(count);
      progress("drawing", kLayoutDone + done * (kDrawingDone - kLayoutDone));
    }
    TRY(auto room,
        derived.Reserve(caller, EstimateDrawing(options, flat.corner_uv.size(), border).bytes));
    auto drawing = Draw(options, flat, order.grain_lines, names, cancel);
    if (!drawing) {
      Fault& fault = drawing.error();
      if (!fault.field.empty()) fault.field = fmt::format("drawings[{}].{}", i, fault.field);
      return Fail(std::move(fault));
    }
    std::size_t own = 0;
    for (const DrawingFile& file : drawing->files) own += file.bytes.size();
    bytes += own;
    if (order.most_bytes > 0 && bytes > order.most_bytes) {
      return Fail(TooLarge("The answer", "max_response_bytes", bytes, order.most_bytes)
                      .Field("max_response_bytes"));
    }
    room.Shrink(own);
    drawn.rooms.push_back(std::move(room));
    drawn.drawings.push_back(*std::move(drawing));
  }
  metrics.Phase(runtime::Phase::kDraw, working.Micros() * 1e-6);
  return drawn;
}

}  // namespace arap::app
