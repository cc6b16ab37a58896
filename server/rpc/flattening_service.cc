// FlatteningService: Flatten and the jobs of it, with their handlers.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <arap/v1/flattening_service.grpc.pb.h>
#include <fmt/format.h>

#include "arap/core/flattener.h"
#include "core/base/try.h"
#include "core/drawing/captions.h"
#include "core/drawing/draw.h"
#include "proto/convert/flatten.h"
#include "server/budget/faults.h"
#include "server/flattening/drawings.h"
#include "server/flattening/flatten_jobs.h"
#include "server/flattening/prepared_surfaces.h"
#include "server/rpc/convert.h"
#include "server/rpc/long_calls.h"
#include "server/rpc/services.h"
#include "server/rpc/unary.h"
#include "server/runtime/clock.h"

namespace arap::rpc {
namespace {

// Bytes that an answer to the request has for certain, before anything is cut.
std::size_t LeastResponseBytes(const v1::FlattenRequest& request,
                               const std::vector<DrawingOptions>& drawings) {
  const auto varint = [](std::uint32_t value) {
    std::size_t bytes = 1;
    for (; value >= 128; value >>= 7u) ++bytes;
    return bytes;
  };
  const auto vertices = static_cast<std::uint32_t>(request.mesh().vertices_size() / 3);
  const auto triangles = static_cast<std::size_t>(request.mesh().triangles_size() / 3);
  std::size_t bytes = std::size_t{vertices} * (request.float64() ? 16 : 8) + triangles;
  if (request.include_first_step()) bytes += std::size_t{vertices} * 16;
  if (request.include_singular_values()) bytes += triangles * 8;
  for (const DrawingOptions& options : drawings) bytes += LeastDrawingBytes(options, triangles);
  for (std::uint32_t v = 0; v < vertices; ++v) bytes += varint(v);
  // A copy along a cut has a larger number than the vertex; one that stands for it has a lower one.
  if (request.repair().weld()) return bytes + 3 * triangles;
  for (const std::uint32_t v : request.mesh().triangles()) bytes += varint(v);
  return bytes;
}

Status CheckResponse(std::uint64_t bytes, std::uint64_t most) {
  if (most == 0 || bytes <= most) return {};
  return Fail(
      app::TooLarge("The answer", "max_response_bytes", bytes, most).Field("max_response_bytes"));
}

struct Asked {
  FlattenOptions options;
  std::vector<DrawingOptions> drawings;
  std::vector<NamedPart> parts;
  SurfaceMesh mesh;
};

Result<std::vector<DrawingOptions>> CheckedDrawings(const v1::FlattenRequest& request) {
  TRY(auto drawings, convert::DrawingsFromWire(request));
  for (std::size_t i = 0; i < drawings.size(); ++i) {
    auto good = CheckDrawing(drawings[i]);
    if (good) continue;
    Fault& fault = good.error();
    fault.field = fmt::format("drawings[{}].{}", i, fault.field);
    return Fail(std::move(fault));
  }
  return drawings;
}

// Everything that can be said of a request before memory is taken or work is done.
Result<Asked> Check(const v1::FlattenRequest& request, const Limits& limits) {
  CHECK_OK(CheckBudget(request, limits));
  Asked asked;
  TRY(asked.options, FromWire(request, limits.max_refine));
  const auto triangles = static_cast<std::size_t>(request.mesh().triangles_size() / 3);
  if (auto good = CheckFlattenOptions(asked.options, triangles); !good) {
    return Fail(convert::SpelledForFlatten(std::move(good.error())));
  }
  TRY(asked.drawings, CheckedDrawings(request));
  asked.parts = convert::PartsFromWire(request);
  CHECK_OK(CheckParts(asked.parts, triangles));
  if (request.max_response_bytes() > 0) {
    CHECK_OK(
        CheckResponse(LeastResponseBytes(request, asked.drawings), request.max_response_bytes()));
  }
  const MeshLimits bounds{limits.max_vertices, limits.max_triangles};
  TRY(asked.mesh, FromWire(request.mesh(), bounds));
  return asked;
}

// What the drawings are expected to take, with an outline as a disk has it.
double DrawingMilliseconds(const std::vector<DrawingOptions>& drawings, std::size_t triangles) {
  const auto border = static_cast<std::size_t>(4 * std::sqrt(static_cast<double>(triangles)));
  double sum = 0;
  for (const DrawingOptions& options : drawings) {
    sum += EstimateDrawing(options, triangles, border).milliseconds;
  }
  return sum;
}

Status FlattenTelling(app::Engine& engine, const v1::FlattenRequest& request, const Call& call,
                      const FlattenProgress& progress, v1::FlattenResponse* response) {
  const runtime::WallTimer working;
  TRY(auto asked, Check(request, engine.limits));
  auto answer = engine.surfaces.Flatten(call.caller, request.surface_key(), std::move(asked.mesh),
                                        asked.options, call.cancel, progress);
  if (!answer) return Fail(convert::SpelledForFlatten(std::move(answer.error())));
  CHECK_OK(ToWire(answer->flat, request, response));
  const app::DrawingOrder order{asked.drawings, asked.parts, asked.options.grain_lines,
                                request.max_response_bytes()};
  TRY(auto drawn, app::DrawAll(engine.derived, engine.metrics, call.caller, order, answer->flat,
                               call.cancel, progress));
  convert::ToWire(std::move(drawn.drawings), response);
  response->set_surface_cached(answer->cached);
  SetMicros(call.queue_micros, response->mutable_queue_time());
  SetMicros(working.Micros(), response->mutable_solve_time());
  return CheckResponse(response->ByteSizeLong(), request.max_response_bytes());
}

// A job: from the bytes of its request to those of its result.
Result<std::string> FlattenBytes(app::Engine& engine, const app::Caller& caller,
                                 const std::string& bytes, const CancelToken& cancel,
                                 const FlattenProgress& progress) {
  // Bytes and message.
  TRY(const auto room, engine.derived.ReserveForRequest(caller, 2 * bytes.size()));
  v1::FlattenRequest request;
  if (!request.ParseFromString(bytes)) {
    return Fail(FaultKind::kDataLoss, "What was stored of the job is damaged.");
  }
  Call call;
  call.caller = caller;
  call.cancel = cancel;
  v1::FlattenResponse response;
  CHECK_OK(FlattenTelling(engine, request, call, progress, &response));
  constexpr std::size_t kMost = std::numeric_limits<int>::max();  // that protobuf writes
  CHECK_OK(CheckResponse(response.ByteSizeLong(), kMost));
  return response.SerializeAsString();
}

}  // namespace

Status Flatten(app::Engine& engine, const v1::FlattenRequest& request, const Call& call,
               v1::FlattenResponse* response) {
  return FlattenTelling(engine, request, call, {}, response);
}

Status SubmitFlatten(app::Engine& engine, const v1::SubmitFlattenRequest& request, const Call& call,
                     v1::SubmitFlattenResponse* response) {
  TRY(const auto asked, Check(request.flatten(), engine.limits));
  const FlattenCost cost = EstimateFlatten(SizeOf(asked.mesh, asked.options.cut), asked.options,
                                           !request.flatten().surface_key().empty());
  const double milliseconds =
      cost.milliseconds + DrawingMilliseconds(asked.drawings, asked.mesh.triangles.size());
  TRY(const auto job,
      engine.flatten_jobs.Submit(call.caller, request.session_id(), request.job_id(),
                                 request.flatten().SerializeAsString(), 1e-3 * milliseconds));
  ToWire(job, response->mutable_job());
  return {};
}

Status GetResult(app::Engine& engine, const v1::GetResultRequest& request, const Call& call,
                 v1::GetResultResponse* response) {
  std::size_t most = engine.limits.max_message_bytes;
  if (request.max_response_bytes() > 0) most = std::min(most, request.max_response_bytes());
  TRY(const auto result,
      engine.flatten_jobs.ResultOf(call.caller, request.session_id(), request.job_id(), most));
  if (response->mutable_flatten()->ParseFromString(result.bytes)) return {};
  return Fail(FaultKind::kDataLoss, "What was stored of the result is damaged.");
}

Status CancelJob(app::Engine& engine, const v1::CancelJobRequest& request, const Call& call,
                 v1::CancelJobResponse* response) {
  TRY(const auto job,
      engine.flatten_jobs.Cancel(call.caller, request.session_id(), request.job_id()));
  ToWire(job, response->mutable_job());
  return {};
}

namespace {

Expected ExpectFlatten(app::Engine& engine, const app::Session*,
                       const v1::FlattenRequest& request) {
  const auto options = convert::FromWire(request, engine.limits.max_refine);
  const auto drawings = convert::DrawingsFromWire(request);
  if (!options || !drawings) return {};
  // By lengths alone: as if it were one chart, which is the most that it can take.
  const auto vertices = static_cast<std::size_t>(request.mesh().vertices_size()) / 3;
  const auto triangles = static_cast<std::size_t>(request.mesh().triangles_size()) / 3;
  const double layout =
      EstimateFlatten({vertices, triangles, 1, vertices}, *options, !request.surface_key().empty())
          .milliseconds;
  return {false, 1e-3 * (layout + DrawingMilliseconds(*drawings, triangles))};
}

}  // namespace

NamedService MakeFlatteningService(const Backend& backend) {
  app::Engine& engine = backend.engine;
  engine.flatten_jobs.Do([&engine](const auto&... job) { return FlattenBytes(engine, job...); });
  auto service = std::make_unique<Methods>(backend, v1::FlatteningService::service_full_name());
  service->Unary({"Flatten", Cost::kHeavy, false, &engine.flattenings}, Flatten, ExpectFlatten);
  service->Unary({"SubmitFlatten", Cost::kStore}, SubmitFlatten);
  service->Unary({"GetResult", Cost::kStore}, GetResult);
  service->Unary({"CancelJob", Cost::kStore}, CancelJob);
  service->Stream<v1::WatchJobRequest, v1::WatchJobResponse>(
      "WatchJob", [backend](Methods::Context* context) {
        return WatchJob(backend.engine, backend.identity, context);
      });
  service->Stream<v1::DownloadResultRequest, v1::DownloadResultResponse>(
      "DownloadResult", [backend](Methods::Context* context) {
        return DownloadResult(backend.engine, backend.identity, context);
      });
  return Named(std::move(service));
}

}  // namespace arap::rpc
