// Live streams for C.
#include <optional>
#include <utility>
#include <variant>

#include "arap/client/deform_stream.h"
#include "client/c/objects.h"

using arap::Status;
using arap::c::Guard;
using arap::c::Need;
namespace client = arap::client;

// NOLINTBEGIN(readability-identifier-naming): the names of C.
struct arap_stream {
  client::DeformStream stream;
};

struct arap_event {
  std::int32_t kind = ARAP_EVENT_END;
  std::uint64_t sequence = 0;
  std::optional<arap_shape> shape = {};
  std::optional<arap_error> error = {};
};
// NOLINTEND(readability-identifier-naming)

namespace arap::c {
namespace {

// An event, unless it is one that C does not see.
std::unique_ptr<arap_event> EventOf(std::optional<client::StreamEvent>&& event) {
  auto ours = std::make_unique<arap_event>();
  if (!event) return ours;
  if (auto* shape = std::get_if<client::Shape>(&*event)) {
    ours->kind = ARAP_EVENT_SHAPE;
    ours->sequence = shape->sequence;
    ours->shape.emplace(arap_shape{std::move(*shape)});
  } else if (auto* refused = std::get_if<client::UpdateError>(&*event)) {
    ours->kind = ARAP_EVENT_REFUSED;
    ours->sequence = refused->sequence;
    ours->error.emplace(std::move(refused->fault));
  } else if (std::holds_alternative<client::Resumed>(*event)) {
    ours->kind = ARAP_EVENT_RESUMED;
  } else {
    return nullptr;  // the answer to a ping
  }
  return ours;
}

}  // namespace

}  // namespace arap::c

extern "C" {

arap_error* arap_open_stream(const arap_session* session, const char* handle_set_id,
                             const arap_stream_options* options, const arap_call_options* call,
                             arap_stream** out) {
  return Guard([&]() -> Status {
    CHECK_OK(Need(session, "session"));
    CHECK_OK(Need(out, "out"));
    TRY(const auto id, arap::c::IdOf(handle_set_id, "handle_set_id"));
    TRY(const auto given, arap::c::OptionsOf(options, "options"));
    client::StreamOptions ours;
    ours.delivery = given.every != 0 ? client::Delivery::kEvery : client::Delivery::kLatest;
    TRY(ours.shape, arap::c::ShapeOptionsOf(given.shape, "options.shape"));
    const std::chrono::milliseconds none{0};
    ours.heartbeat = arap::c::MillisOf(given.heartbeat_ms, ours.heartbeat, none);
    ours.silence = arap::c::MillisOf(given.silence_ms, ours.silence, ours.silence);
    ours.answer = arap::c::MillisOf(given.answer_ms, ours.answer, ours.answer);
    ours.resume_within = arap::c::MillisOf(given.resume_within_ms, none, none);
    TRY(const auto calling, arap::c::CallOf(call));
    TRY(auto stream, session->session.OpenStream(id, ours, calling));
    *out = new arap_stream{std::move(stream)};
    return {};
  });
}

arap_error* arap_stream_move(arap_stream* stream, uint64_t sequence, const double* positions,
                             size_t handle_count) {
  return Guard([&]() -> Status {
    CHECK_OK(Need(stream, "stream"));
    client::HandleUpdate update;
    update.sequence = sequence;
    TRY(update.positions, arap::c::PointsOf(positions, handle_count, "positions"));
    return stream->stream.Send(update);
  });
}

arap_error* arap_stream_move_some(arap_stream* stream, uint64_t sequence,
                                  const arap_target* targets, size_t target_count) {
  return arap_stream_move_and_pick(stream, sequence, targets, target_count, nullptr, 0);
}

arap_error* arap_stream_move_and_pick(arap_stream* stream, uint64_t sequence,
                                      const arap_target* targets, size_t target_count,
                                      const double* points, size_t point_count) {
  return Guard([&]() -> Status {
    CHECK_OK(Need(stream, "stream"));
    client::HandleUpdate update;
    update.sequence = sequence;
    TRY(update.targets, arap::c::TargetsOf(targets, target_count));
    TRY(update.pick_points, arap::c::PointsOf(points, point_count, "points"));
    return stream->stream.Send(update);
  });
}

arap_error* arap_stream_measure(arap_stream* stream, uint64_t sequence) {
  return Guard([&]() -> Status {
    CHECK_OK(Need(stream, "stream"));
    client::HandleUpdate update;
    update.sequence = sequence;
    update.measure = true;
    return stream->stream.Send(update);
  });
}

arap_error* arap_stream_edit(arap_stream* stream, uint64_t sequence, const char* const* remove,
                             size_t remove_count, const arap_handle* add, size_t add_count) {
  return Guard([&]() -> Status {
    CHECK_OK(Need(stream, "stream"));
    TRY(const auto gone, arap::c::IdsOf(remove, remove_count, "remove"));
    TRY(const auto added, arap::c::HandlesOf(add, add_count, "add"));
    return stream->stream.Edit(sequence, gone, added);
  });
}

arap_error* arap_stream_close_sending(arap_stream* stream) {
  return Guard([&]() -> Status {
    CHECK_OK(Need(stream, "stream"));
    return stream->stream.CloseSending();
  });
}

void arap_stream_cancel(arap_stream* stream) {
  if (stream != nullptr) stream->stream.Cancel();
}

void arap_stream_free(arap_stream* stream) { delete stream; }

arap_error* arap_stream_take(arap_stream* stream, arap_event** out) {
  return Guard([&]() -> Status {
    CHECK_OK(Need(stream, "stream"));
    CHECK_OK(Need(out, "out"));
    std::unique_ptr<arap_event> event;
    while (event == nullptr) {
      TRY(auto read, stream->stream.Read());
      event = arap::c::EventOf(std::move(read));
    }
    *out = event.release();
    return {};
  });
}

int32_t arap_event_kind(const arap_event* event) { return event->kind; }
uint64_t arap_event_sequence(const arap_event* event) { return event->sequence; }
const arap_shape* arap_event_shape(const arap_event* event) {
  return event->shape ? &*event->shape : nullptr;
}
const arap_error* arap_event_error(const arap_event* event) {
  return event->error ? &*event->error : nullptr;
}
void arap_event_free(arap_event* event) { delete event; }

}  // extern "C"
