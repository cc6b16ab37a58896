#include "tests/server/store/records.h"

#include <bit>
#include <cstdint>
#include <cstring>
#include <utility>

namespace arap::testing {
namespace {

using store::SessionRecord;

std::uint64_t Bits(Random& random) {
  std::uint64_t bits = 0;
  for (int i = 0; i < 4; ++i) bits = bits << 16u | random.Below(1u << 16u);
  return bits;
}

double AnyDouble(Random& random) {
  switch (random.Below(4)) {
    case 0:
      return random.Uniform(-1e3, 1e3);
    case 1:
      return static_cast<double>(random.Below(2000)) - 1000;
    case 2: {
      constexpr double kSpecial[] = {0.0, -0.0, 5e-324, 1e308, -1e-310, 0.1, 9007199254740993.0};
      return kSpecial[random.Below(std::size(kSpecial))];
    }
    default:
      return std::bit_cast<double>(Bits(random));
  }
}

std::string AnyText(Random& random) {
  constexpr const char* kPieces[] = {"a", "Z",  "\"",   "\\", "\n", "\x01",
                                     "ä", "漢", "🙂", " ",  "/"};
  std::string text;
  for (std::size_t i = random.Below(12); i > 0; --i)
    text += kPieces[random.Below(std::size(kPieces))];
  if (random.Below(8) == 0) text += '\0';
  return text;
}

Handle AnyHandle(Random& random) {
  Handle handle;
  handle.id = AnyText(random);
  const auto index = static_cast<std::uint32_t>(Bits(random));
  switch (random.Below(3)) {
    case 0:
      handle.anchor = VertexAnchor{index};
      break;
    case 1:
      handle.anchor =
          TriangleAnchor{index, {AnyDouble(random), AnyDouble(random), AnyDouble(random)}};
      break;
    default:
      handle.anchor = PointAnchor{{AnyDouble(random), AnyDouble(random)}};
  }
  handle.weight = AnyDouble(random);
  handle.hard = random.Coin();
  handle.oriented = random.Coin();
  handle.area_radius = AnyDouble(random);
  handle.outside = random.Coin() ? Outside::kSnap : Outside::kError;
  handle.depth = AnyDouble(random);
  handle.depth_falloff = AnyDouble(random);
  return handle;
}

bool Same(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }
bool Same(Complex a, Complex b) { return Same(a.real(), b.real()) && Same(a.imag(), b.imag()); }

bool SameAnchor(const Handle& a, const Handle& b) {
  if (a.anchor.index() != b.anchor.index()) return false;
  if (const auto* vertex = std::get_if<VertexAnchor>(&a.anchor)) {
    return vertex->vertex == std::get<VertexAnchor>(b.anchor).vertex;
  }
  if (const auto* triangle = std::get_if<TriangleAnchor>(&a.anchor)) {
    const auto& other = std::get<TriangleAnchor>(b.anchor);
    return triangle->triangle == other.triangle &&
           std::memcmp(triangle->barycentric.data(), other.barycentric.data(),
                       sizeof other.barycentric) == 0;
  }
  return Same(std::get<PointAnchor>(a.anchor).position, std::get<PointAnchor>(b.anchor).position);
}

std::string Difference(const Handle& a, const Handle& b) {
  if (a.id != b.id) return "id of a handle";
  if (!SameAnchor(a, b)) return "anchor";
  if (!Same(a.weight, b.weight)) return "weight";
  if (a.hard != b.hard || a.oriented != b.oriented || a.outside != b.outside) return "a flag";
  if (!Same(a.area_radius, b.area_radius)) return "area_radius";
  if (!Same(a.depth, b.depth) || !Same(a.depth_falloff, b.depth_falloff)) return "depth";
  return {};
}

std::string Difference(const store::HandleSetRecord& a, const store::HandleSetRecord& b) {
  if (a.mesh_id != b.mesh_id) return "mesh_id";
  if (a.revision != b.revision) return "revision of a handle set";
  if (a.definitions->size() != b.definitions->size()) return "number of handles";
  for (std::size_t i = 0; i < a.definitions->size(); ++i) {
    if (auto what = Difference((*a.definitions)[i], (*b.definitions)[i]); !what.empty())
      return what;
  }
  return {};
}

}  // namespace

runtime::Clock::Wall Now() {
  return std::chrono::floor<std::chrono::milliseconds>(std::chrono::system_clock::now());
}

SessionRecord PlainRecord(const std::string& owner, const std::string& id, char digit) {
  SessionRecord record;
  record.key = {owner, id};
  record.incarnation = "00112233aabbccdd";
  record.ttl = std::chrono::hours(1);
  record.created = Now();
  record.expires = record.created + record.ttl;
  record.meshes["face"].blob = std::string(64, digit);
  Handle handle;
  handle.id = "nose";
  handle.anchor = PointAnchor{{0.1, -0.2}};
  record.handle_sets["drag"] = {"face", store::MakeDefinitions({handle}), 1};
  return record;
}

SessionRecord RandomRecord(Random& random) {
  SessionRecord record;
  record.key = {AnyText(random), AnyText(random)};
  record.incarnation = AnyText(random);
  record.ttl = std::chrono::milliseconds(random.Below(1u << 30u));
  record.created = Now() + std::chrono::milliseconds(random.Below(1000));
  record.expires = Now() + std::chrono::milliseconds(random.Below(1u << 30u));
  record.revision = Bits(random);
  for (std::size_t i = random.Below(4); i > 0; --i)
    record.labels[AnyText(random)] = AnyText(random);
  for (std::size_t i = random.Below(4); i > 0; --i) {
    record.meshes[AnyText(random)] = {AnyText(random), random.Below(1u << 30u)};
  }
  for (std::size_t i = random.Below(3); i > 0; --i) {
    store::HandleSetRecord set{AnyText(random), {}, Bits(random)};
    std::vector<Handle> handles;
    for (std::size_t j = random.Below(5); j > 0; --j) handles.push_back(AnyHandle(random));
    set.definitions = store::MakeDefinitions(std::move(handles));
    record.handle_sets[AnyText(random)] = std::move(set);
  }
  return record;
}

SessionRecord Next(SessionRecord record) {
  ++record.revision;
  return record;
}

std::string Difference(const SessionRecord& a, const SessionRecord& b) {
  if (a.key != b.key) return "key";
  if (a.incarnation != b.incarnation) return "incarnation";
  if (a.ttl != b.ttl) return "ttl";
  if (a.labels != b.labels) return "labels";
  if (a.created != b.created) return "created";
  if (a.expires != b.expires) return "expires";
  if (a.revision != b.revision) return "revision";
  if (a.meshes.size() != b.meshes.size()) return "number of meshes";
  for (auto i = a.meshes.begin(), j = b.meshes.begin(); i != a.meshes.end(); ++i, ++j) {
    if (i->first != j->first || i->second.blob != j->second.blob) return "meshes";
    if (i->second.bytes != j->second.bytes) return "bytes of a mesh";
  }
  if (a.handle_sets.size() != b.handle_sets.size()) return "number of handle sets";
  for (auto i = a.handle_sets.begin(), j = b.handle_sets.begin(); i != a.handle_sets.end();
       ++i, ++j) {
    if (i->first != j->first) return "handle set id";
    if (auto what = Difference(i->second, j->second); !what.empty()) return what;
  }
  return {};
}

}  // namespace arap::testing
