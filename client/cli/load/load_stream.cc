#include "client/cli/load/load_stream.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "client/cli/report.h"
#include "client/cli/sample/samples.h"
#include "core/base/try.h"

namespace arap::cli {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kLoadSet = "load";

void Note(const Fault& fault, LoadSamples& samples) {
  ++samples.errors[ReasonOf(fault)];
  if (samples.first_error.empty()) samples.first_error = Describe(fault);
}

void NoteBadReply(const std::string& what, LoadSamples& samples) {
  ++samples.errors["BAD_REPLY"];
  if (samples.first_error.empty()) samples.first_error = "BAD_REPLY: " + what;
}

// Every handle goes round its rest position, each at its own phase.
std::vector<Complex> Targets(const LoadPlan& plan, std::size_t stream, std::uint64_t step) {
  constexpr double kStepRadians = 0.05;
  std::vector<Complex> targets = plan.rests;
  for (std::size_t k = 0; k < targets.size(); ++k) {
    const double angle = kStepRadians * static_cast<double>(step) + static_cast<double>(k + stream);
    targets[k] += plan.reach * Complex(std::sin(angle), 1 - std::cos(angle));
  }
  return targets;
}

// The reply's shape if it is the right one.
const client::Shape* CheckReply(const Result<std::optional<client::StreamEvent>>& event,
                                std::uint64_t sequence, LoadSamples& samples) {
  if (!event) {
    Note(event.error(), samples);
    return nullptr;
  }
  if (!*event) {
    NoteBadReply("the server ended the stream", samples);
    return nullptr;
  }
  if (const auto* error = std::get_if<client::UpdateError>(&**event)) {
    Note(error->fault, samples);
    return nullptr;
  }
  const auto* shape = std::get_if<client::Shape>(&**event);
  if (shape == nullptr || shape->sequence != sequence) {
    NoteBadReply("not the answer to the update", samples);
    return nullptr;
  }
  return shape;
}

Result<client::DeformStream> OpenStream(const client::Session& session, const LoadPlan& plan,
                                        const client::CallOptions& call, LoadSamples& samples) {
  TRY(const auto registered, session.RegisterMesh(plan.mesh, {}, {}, call));
  TRY([[maybe_unused]] const auto set,
      session.CompileHandles(kLoadSet, registered.mesh.id, plan.handles, call));
  const Clock::time_point asked = Clock::now();
  client::StreamOptions options{plan.delivery, {plan.deform}};
  options.heartbeat = {};  // a thread for each stream
  auto stream = session.OpenStream(kLoadSet, options, call);
  const std::chrono::duration<double, std::micro> took = Clock::now() - asked;
  if (!stream && stream.error().kind == FaultKind::kLimitExceeded) {
    samples.refused_micros.push_back(took.count());
  }
  return stream;
}

void Drive(client::DeformStream& stream, const LoadPlan& plan, std::size_t index,
           LoadSamples& samples) {
  const Clock::time_point end =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(plan.length);
  client::HandleUpdate update;
  const auto apart = std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(plan.fps > 0 ? 1 / plan.fps : 0));
  Clock::time_point due = Clock::now();
  while (Clock::now() < end) {
    if (plan.fps > 0) std::this_thread::sleep_until(due);
    ++update.sequence;
    update.positions = Targets(plan, index, update.sequence);
    const Clock::time_point sent = plan.fps > 0 ? due : Clock::now();
    due += apart;
    (void)stream.Send(update);  // a failure is explained by the read
    const auto event = stream.Read();
    const std::chrono::duration<double, std::micro> took = Clock::now() - sent;
    const client::Shape* const shape = CheckReply(event, update.sequence, samples);
    if (shape == nullptr) {
      if (!event || !*event) return;  // the stream is over
      continue;
    }
    samples.round_trip_micros.push_back(took.count());
    samples.queue_micros.push_back(shape->queue_micros);
    samples.solve_micros.push_back(shape->solve_micros);
  }
}

}  // namespace

LoadPlan MakeLoadPlan(std::size_t vertices, std::size_t handles,
                      std::chrono::duration<double> length) {
  LoadPlan plan;
  plan.length = length;
  const auto side = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(vertices))));
  const std::size_t columns = std::max<std::size_t>(side, 2);
  const std::size_t rows = std::max<std::size_t>(vertices / columns, 2);
  plan.mesh = MakeGrid(columns, rows);
  const double width = static_cast<double>(columns - 1);
  const double height = static_cast<double>(rows - 1);
  plan.reach = 0.1 * std::min(width, height);
  for (std::size_t k = 0; k < handles; ++k) {
    // On a sunflower's spiral: evenly spread for any number of them.
    const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
    const double radius =
        0.45 * std::sqrt((static_cast<double>(k) + 0.5) / static_cast<double>(handles));
    const double x = width * (0.5 + radius * std::cos(golden * static_cast<double>(k)));
    const double y = height * (0.5 + radius * std::sin(golden * static_cast<double>(k)));
    Handle& handle = plan.handles.emplace_back();
    handle.id = fmt::format("h{}", k);
    handle.anchor = PointAnchor{{x, y}};
    plan.rests.emplace_back(x, y);
  }
  return plan;
}

LoadSamples RunLoadStream(const client::Client& client, const LoadPlan& plan, std::size_t index,
                          std::latch& start) {
  LoadSamples samples;
  // A server that hangs must not keep us for ever.
  client::CallOptions call;
  call.timeout =
      std::chrono::duration_cast<std::chrono::milliseconds>(plan.length) + std::chrono::seconds(60);
  const Result<client::Session> session = client.CreateSession({}, call);
  std::optional<client::DeformStream> stream;
  if (!session) {
    Note(session.error(), samples);
  } else if (Result<client::DeformStream> opened = OpenStream(*session, plan, call, samples)) {
    stream = std::move(*opened);
  } else {
    Note(opened.error(), samples);
  }
  // Also without a stream: the others wait for us.
  if (plan.fps > 0) {
    start.count_down();
  } else {
    start.arrive_and_wait();
  }
  if (stream) {
    Drive(*stream, plan, index, samples);
    stream.reset();
  }
  if (session) (void)session->Delete(call);
  return samples;
}

}  // namespace arap::cli
