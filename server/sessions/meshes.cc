#include "server/sessions/meshes.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "arap/core/cost.h"
#include "core/base/names.h"
#include "core/base/try.h"
#include "core/outline/quality_mesh.h"
#include "core/outline/shape.h"
#include "core/token/digest.h"
#include "server/budget/faults.h"
#include "server/runtime/clock.h"
#include "server/runtime/metrics.h"

namespace arap::app {
namespace {

constexpr std::size_t kDefaultIdLength = 32;

// Whether the record has this very mesh under the id already. kAlreadyExists for another one,
// kLimitExceeded when there is no room for one more.
Result<bool> HasMesh(const store::SessionRecord& record, const std::string& mesh_id,
                     const std::string& blob, const Limits& limits) {
  if (const auto found = record.meshes.find(mesh_id); found != record.meshes.end()) {
    if (found->second.blob == blob) return true;
    return Fail(Taken("mesh", mesh_id, "another mesh or other options"));
  }
  if (record.meshes.size() >= limits.max_meshes_per_session) {
    return Fail(QuotaFull("max_meshes_per_session", limits.max_meshes_per_session));
  }
  return false;
}

// Registers a mesh in memory that is reserved for it.
Result<std::shared_ptr<const RegisteredMesh>> Factor(Workshop& workshop, const Caller& caller,
                                                     PlanarMesh mesh, const EnergyOptions& options,
                                                     const RepairOptions& repairs,
                                                     const MeshLimits& limits,
                                                     const CancelToken& cancel) {
  TRY(const auto room,
      workshop.derived.Reserve(caller,
                               EstimateRegistration(mesh.vertices.size(), options.basis).bytes));
  return RegisteredMesh::Register(std::move(mesh), options, repairs, limits, cancel);
}

Result<std::shared_ptr<const RegisteredMesh>> FactorNew(Workshop& workshop, const Caller& caller,
                                                        PlanarMesh mesh,
                                                        const EnergyOptions& options,
                                                        const RepairOptions& repairs,
                                                        const CancelToken& cancel) {
  // Before memory is taken: what is asked amiss stays so however much room there is.
  CHECK_OK(RegisteredMesh::CheckOptions(options, mesh.triangles.size()));
  return Factor(workshop, caller, std::move(mesh), options, repairs,
                {workshop.limits.max_vertices, workshop.limits.max_triangles}, cancel);
}

Result<std::shared_ptr<const RegisteredMesh>> Rebuild(Workshop& workshop, const Caller& caller,
                                                      const std::string& blob,
                                                      const CancelToken& cancel) {
  TRY(auto bytes, workshop.stores.blobs->Get(blob));
  TRY(auto stored, DecodeMesh(bytes));
  bytes = {};
  // What was accepted once stays, also when the limits have shrunk since.
  constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();
  const runtime::WallTimer working;
  TRY(auto mesh, Factor(workshop, caller, std::move(stored.mesh), stored.options, stored.repairs,
                        {kAny, kAny}, cancel));
  workshop.metrics.Phase(runtime::Phase::kRebuild, working.Micros() * 1e-6);
  return mesh;
}

// Blobs are named by their digest; the client knows its mesh by the id.
Fault NamingMesh(Fault fault, const std::string& mesh_id) {
  if (fault.kind == FaultKind::kDataLoss) {
    fault.message = "The stored mesh " + Quote(mesh_id) + " cannot be read: " + fault.message;
    fault.Detail("mesh", mesh_id);
  }
  return fault;
}

// Keeps what was just computed and stored. Returns the entry that is kept: an equal one that came
// first.
MeshEntry KeepWarm(Workshop& workshop, const std::string& owner, MeshEntry entry) {
  const std::size_t bytes = entry.mesh->report().bytes;
  entry.mesh = workshop.derived.Keep<RegisteredMesh>(MeshKey(owner, entry.content_hash),
                                                     std::move(entry.mesh), bytes);
  return entry;
}

// To be changed whenever the same mesh would get other factors.
constexpr std::string_view kTag = "arap planar mesh 1\n";
constexpr std::string_view kMendedTag = "arap planar mesh 2\n";

// Repairs as bits of a number.
constexpr std::uint64_t kWeld = 1, kDropDuplicates = 2, kStitch = 4, kTolerance = 8, kAll = 15;

void Append(std::string& bytes, const void* data, std::size_t size) {
  bytes.append(static_cast<const char*>(data), size);
}
void AppendNumber(std::string& bytes, std::uint64_t number) {
  Append(bytes, &number, sizeof number);
}
template <class T>
void AppendArray(std::string& bytes, const std::vector<T>& items) {
  AppendNumber(bytes, items.size());
  Append(bytes, items.data(), items.size() * sizeof(T));
}

// Takes bytes from the front. After the first read that fails all others fail too.
class BlobReader {
 public:
  explicit BlobReader(std::string_view bytes) : left_(bytes) {}

  bool Tag(std::string_view tag) {
    if (!left_.starts_with(tag)) return false;
    left_.remove_prefix(tag.size());
    return true;
  }
  bool Number(std::uint64_t& number) {
    if (left_.size() < sizeof number) return false;
    std::memcpy(&number, left_.data(), sizeof number);
    left_.remove_prefix(sizeof number);
    return true;
  }
  template <class T>
  bool Array(std::vector<T>& items) {
    std::uint64_t count = 0;
    if (!Number(count) || count > left_.size() / sizeof(T)) return false;
    items.resize(static_cast<std::size_t>(count));
    const std::size_t size = items.size() * sizeof(T);
    if (size > 0) std::memcpy(static_cast<void*>(items.data()), left_.data(), size);
    left_.remove_prefix(size);
    return true;
  }
  bool AtEnd() const { return left_.empty(); }

 private:
  std::string_view left_;
};

}  // namespace

Result<Registration> RegisterMesh(Workshop& workshop, const Caller& caller,
                                  const std::string& session_id, std::string mesh_id,
                                  PlanarMesh mesh, const EnergyOptions& options,
                                  const CancelToken& cancel, const RepairOptions& repairs) {
  const runtime::WallTimer working;
  TRY(const auto session, workshop.sessions.Use(caller.owner, session_id));
  if (!mesh_id.empty()) CHECK_OK(CheckName(mesh_id, "mesh_id"));
  const std::string bytes = EncodeMesh(mesh, options, repairs);
  TRY(const std::string hash, Sha256Hex(bytes));
  if (mesh_id.empty()) mesh_id = hash.substr(0, kDefaultIdLength);

  TRY(const bool has, HasMesh(*session->record(), mesh_id, hash, workshop.limits));
  MeshEntry entry{mesh_id, hash,
                  workshop.derived.Find<RegisteredMesh>(MeshKey(caller.owner, hash))};
  const bool shared = entry.mesh != nullptr;
  if (!has) CHECK_OK(workshop.sessions.MayStore(caller, {.meshes = 1, .bytes = bytes.size()}));
  if (!shared) {
    TRY(entry.mesh, FactorNew(workshop, caller, std::move(mesh), options, repairs, cancel));
  }
  if (!has) {
    // The blob first: a record never names what is not there.
    CHECK_OK(workshop.stores.blobs->Put(hash, bytes));
    const auto add = [&](store::SessionRecord& record) -> Result<bool> {
      TRY(const bool there, HasMesh(record, mesh_id, hash, workshop.limits));
      if (!there) record.meshes[mesh_id] = {hash, bytes.size()};
      return !there;
    };
    TRY(const auto stored, workshop.sessions.Change(caller, *session, add));
  }
  entry = KeepWarm(workshop, caller.owner, std::move(entry));
  if (!shared) workshop.metrics.Phase(runtime::Phase::kRegister, working.Micros() * 1e-6);
  return Registration{std::move(entry), shared};
}

namespace {

std::size_t VerticesOf(const OutlineOptions& options) {
  constexpr std::size_t kDefault = 1000;
  return options.vertices == 0 ? kDefault : options.vertices;
}

// What a mesh inside outlines may have: enough for all that is not meant to be slow.
std::size_t MostVertices(std::size_t points, std::size_t vertices) {
  return 4 * (points + vertices) + 1000;
}

Fault InOutlines(Fault fault) {
  if (fault.field.empty()) fault.Field("outlines");
  return fault;
}

Result<ShapedOutlines> Shape(Workshop& workshop, const Caller& caller,
                             const std::vector<Outline>& outlines, const OutlineOptions& options,
                             const CancelToken& cancel) {
  // Before memory is taken: what is asked amiss stays so however much room there is.
  CHECK_OK(CheckShaping(outlines, options));
  TRY(const auto room,
      workshop.derived.Reserve(caller, EstimateShaping(PointsOf(outlines), options).bytes));
  return ShapeOutlines(outlines, options, cancel);
}

}  // namespace

Result<QualityMesh> MeshOutlines(Workshop& workshop, const Caller& caller,
                                 const std::vector<Outline>& outlines,
                                 const OutlineOptions& options, const CancelToken& cancel) {
  const std::size_t limit = workshop.limits.max_vertices, vertices = VerticesOf(options);
  if (vertices > limit) {
    return Fail(TooLarge("vertex_count", "max_vertices", vertices, limit).Field("vertex_count"));
  }
  const auto shaped = Shape(workshop, caller, outlines, options, cancel);
  if (!shaped) return Fail(InOutlines(shaped.error()));
  const std::size_t points = PointsOf(shaped->outlines);
  const std::size_t most = std::min(limit, MostVertices(points, vertices));
  TRY(const auto room,
      workshop.derived.Reserve(caller, EstimateMeshing(points, vertices, most).bytes));
  auto mesh = arap::MeshOutlines(shaped->outlines, vertices, most, cancel);
  if (!mesh) return Fail(InOutlines(std::move(mesh.error())));
  mesh->outline_error = shaped->error;
  return mesh;
}

double ExpectMeshing(std::size_t points, const OutlineOptions& options) {
  const std::size_t vertices = VerticesOf(options);
  return EstimateShaping(points, options).seconds +
         EstimateMeshing(points, vertices, MostVertices(points, vertices)).seconds;
}

Result<MeshEntry> WarmMesh(Workshop& workshop, const Caller& caller, const Session& session,
                           const std::string& mesh_id, const CancelToken& cancel) {
  TRY(const auto mesh, FindMesh(*session.record(), mesh_id));
  const DerivedKey key = MeshKey(session.key().owner, mesh.blob);
  if (auto kept = workshop.derived.Find<RegisteredMesh>(key)) {
    return MeshEntry{mesh_id, mesh.blob, std::move(kept)};
  }
  auto rebuilt = Rebuild(workshop, caller, mesh.blob, cancel);
  if (!rebuilt) return Fail(NamingMesh(std::move(rebuilt.error()), mesh_id));
  return KeepWarm(workshop, session.key().owner, {mesh_id, mesh.blob, *std::move(rebuilt)});
}

Status DeleteMesh(Workshop& workshop, const Caller& caller, const std::string& session_id,
                  const std::string& mesh_id) {
  TRY(const auto session, workshop.sessions.Use(caller.owner, session_id));
  std::string blob;
  std::vector<std::string> sets;
  const auto remove = [&](store::SessionRecord& record) -> Result<bool> {
    TRY(const auto mesh, FindMesh(record, mesh_id));
    blob = mesh.blob;
    record.meshes.erase(mesh_id);
    sets.clear();
    std::erase_if(record.handle_sets, [&](const auto& set) {
      if (set.second.mesh_id != mesh_id) return false;
      sets.push_back(set.first);
      return true;
    });
    return true;
  };
  TRY(const auto stored, workshop.sessions.Change(caller, *session, remove));
  for (const std::string& set : sets) workshop.ReleaseHandleSet(session->key(), set);
  workshop.ReleaseMesh(caller.owner, blob);
  return {};
}

PeekedMesh PeekMesh(Workshop& workshop, const Session& session, const std::string& mesh_id) {
  const auto record = session.record();
  const auto mesh = record->meshes.find(mesh_id);
  if (mesh == record->meshes.end()) return {};
  auto kept = workshop.derived.Peek<RegisteredMesh>(MeshKey(record->key.owner, mesh->second.blob));
  return {kept ? Warmth::kWarm : Warmth::kCold, std::move(kept)};
}

DerivedKey MeshKey(const std::string& owner, const std::string& blob) {
  return {owner, DerivedKind::kMesh, blob};
}

std::string EncodeMesh(const PlanarMesh& mesh, const EnergyOptions& options,
                       const RepairOptions& repairs) {
  // Meshes without repairs are what they were before there were any.
  const bool mended = repairs != RepairOptions{};
  std::string bytes(mended ? kMendedTag : kTag);
  bytes.reserve(kTag.size() + 7 * sizeof(std::uint64_t) + options.rigidity.size() * sizeof(double) +
                mesh.vertices.size() * sizeof(Complex) + mesh.triangles.size() * sizeof(Triangle));
  AppendNumber(bytes, static_cast<std::uint64_t>(options.basis));
  AppendNumber(bytes, static_cast<std::uint64_t>(options.weights));
  if (mended) {
    AppendNumber(bytes, (repairs.weld ? kWeld : 0) |
                            (repairs.drop_duplicates ? kDropDuplicates : 0) |
                            (repairs.stitch ? kStitch : 0) | (repairs.tolerance ? kTolerance : 0));
    AppendNumber(bytes, std::bit_cast<std::uint64_t>(repairs.tolerance.value_or(0)));
  }
  AppendArray(bytes, options.rigidity);
  AppendArray(bytes, mesh.vertices);
  AppendArray(bytes, mesh.triangles);
  return bytes;
}

Result<MeshBlob> DecodeMesh(std::string_view bytes) {
  BlobReader reader(bytes);
  MeshBlob blob;
  std::uint64_t basis = 0, weights = 0, repairs = 0, tolerance = 0;
  const bool mended = reader.Tag(kMendedTag);
  const bool good = (mended || reader.Tag(kTag)) && reader.Number(basis) &&
                    reader.Number(weights) &&
                    (!mended || (reader.Number(repairs) && reader.Number(tolerance))) &&
                    repairs <= kAll && basis <= static_cast<std::uint64_t>(Basis::kVertex) &&
                    weights <= static_cast<std::uint64_t>(Weights::kCotangent) &&
                    reader.Array(blob.options.rigidity) && reader.Array(blob.mesh.vertices) &&
                    reader.Array(blob.mesh.triangles) && reader.AtEnd();
  if (!good) return Fail(FaultKind::kDataLoss, "A stored mesh is not in the form of this version.");
  blob.options.basis = static_cast<Basis>(basis);
  blob.options.weights = static_cast<Weights>(weights);
  blob.repairs.weld = (repairs & kWeld) != 0;
  blob.repairs.drop_duplicates = (repairs & kDropDuplicates) != 0;
  blob.repairs.stitch = (repairs & kStitch) != 0;
  if ((repairs & kTolerance) != 0) blob.repairs.tolerance = std::bit_cast<double>(tolerance);
  return blob;
}

}  // namespace arap::app
