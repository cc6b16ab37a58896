#include "client/cli/load/verifier.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "client/cli/load/load_session.h"
#include "core/base/try.h"

namespace arap::cli {
namespace {

// Of the size of the mesh: what the same computation may differ by on another processor.
constexpr double kRounding = 1e-7;
// The handles of the scene and the further one.
constexpr const char* kSetWithExtra = "load-extra";

bool Near(const std::vector<Complex>& a, const std::vector<Complex>& b, double most) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [most](Complex p, Complex q) {
    return std::abs(p.real() - q.real()) <= most && std::abs(p.imag() - q.imag()) <= most;
  });
}

bool Near(double a, double b) { return std::abs(a - b) <= kRounding * std::abs(b); }

}  // namespace

Result<std::unique_ptr<Verifier>> Verifier::Open(const client::Client& reference,
                                                 const LoadScene& scene) {
  TRY(client::Session session, reference.CreateSession());
  TRY(const client::Registration registered, session.RegisterMesh(scene.mesh, {}));
  CHECK_OK(session.CompileHandles(kLoadSet, registered.mesh.id, scene.handles));
  std::vector<Handle> more = scene.handles;
  more.push_back(scene.extra);
  CHECK_OK(session.CompileHandles(kSetWithExtra, registered.mesh.id, more));
  return std::unique_ptr<Verifier>(
      new Verifier(reference, std::move(session), registered.mesh.id, scene));
}

Verifier::Verifier(const client::Client& reference, client::Session session, std::string mesh_id,
                   const LoadScene& scene)
    : reference_(reference),
      session_(std::move(session)),
      mesh_id_(std::move(mesh_id)),
      scene_(scene),
      rounding_(kRounding * 10 * scene.reach),
      thread_([this] { Run(); }) {}

Verifier::~Verifier() {
  {
    const MutexLock lock(&mutex_);
    over_ = true;
    changed_.SignalAll();
  }
  thread_.join();
}

void Verifier::AskShape(Pose pose, client::Shape shape, Told told) {
  Ask({[this, pose = std::move(pose), shape = std::move(shape)] { return IsShape(pose, shape); },
       std::move(told)});
}

void Verifier::AskFlat(std::vector<Complex> uv, Told told) {
  Ask({[this, uv = std::move(uv)] { return IsFlat(uv); }, std::move(told)});
}

void Verifier::AskMesh(double scale, client::MeshInfo info, Told told) {
  Ask({[this, scale, info = std::move(info)] { return IsMesh(scale, info); }, std::move(told)});
}

void Verifier::Ask(Question question) {
  const MutexLock lock(&mutex_);
  if (waiting_.size() >= kMostWaiting) return;
  waiting_.push_back(std::move(question));
  changed_.SignalAll();
}

void Verifier::AwaitAnswers() {
  const MutexLock lock(&mutex_);
  while (!waiting_.empty()) changed_.Wait(&mutex_);
}

void Verifier::Run() {
  for (;;) {
    const Question* question = nullptr;
    {
      const MutexLock lock(&mutex_);
      while (!over_ && waiting_.empty()) changed_.Wait(&mutex_);
      if (over_) return;
      question = &waiting_.front();  // stays where it is while others come behind it
    }
    question->told(question->is_right());
    const MutexLock lock(&mutex_);
    waiting_.pop_front();
    changed_.SignalAll();
  }
}

Result<std::vector<Complex>> Verifier::PositionsOf(const Pose& pose) const {
  std::vector<HandleTarget> targets;
  for (std::size_t k = 0; k < pose.targets.size(); ++k) {
    targets.push_back({scene_.handles[k].id, {pose.targets[k]}});
  }
  if (pose.extra_since) {
    // Where that shape had it.
    TRY(const std::vector<Complex> before,
        PositionsOf({.targets = *pose.extra_since, .deform = pose.deform}));
    const auto& anchor = std::get<TriangleAnchor>(scene_.extra.anchor);
    const Triangle& triangle = scene_.mesh.triangles[anchor.triangle];
    Complex at = 0;
    for (std::size_t i = 0; i < 3; ++i) at += anchor.barycentric[i] * before[triangle[i]];
    targets.push_back({scene_.extra.id, {at}});
  }
  const client::ShapeOptions options{.deform = pose.deform, .float64 = true};
  TRY(client::Shape shape,
      session_.Deform(pose.extra_since ? kSetWithExtra : kLoadSet, targets, options));
  return std::move(shape.positions);
}

Result<bool> Verifier::IsShape(const Pose& pose, const client::Shape& shape) const {
  TRY(const std::vector<Complex> positions, PositionsOf(pose));
  return Near(shape.positions, positions, shape.position_error + rounding_);
}

Result<bool> Verifier::IsFlat(const std::vector<Complex>& uv) {
  if (!uv_) {
    TRY(client::FlatSurface surface, reference_.Flatten(scene_.surface, {.float64 = true}));
    uv_ = std::move(surface.flat.uv);
  }
  // Single precision is of the coordinates.
  double most = 0;
  for (const Complex p : *uv_) most = std::max({most, std::abs(p.real()), std::abs(p.imag())});
  return Near(uv, *uv_, rounding_ + kRounding * most);
}

Result<bool> Verifier::IsMesh(double scale, const client::MeshInfo& info) const {
  PlanarMesh mesh = scene_.mesh;
  for (Complex& p : mesh.vertices) p *= scale;
  TRY(const client::Registration registered, session_.RegisterMesh(mesh, {}));
  const client::MeshInfo& here = registered.mesh;
  // The handles are on that one.
  if (here.id != mesh_id_) CHECK_OK(session_.DeleteMesh(here.id));
  const RegistrationReport& a = info.report;
  const RegistrationReport& b = here.report;
  return info.content_hash == here.content_hash && a.edges == b.edges &&
         a.components == b.components && a.boundary_loops == b.boundary_loops &&
         Near(a.area, b.area) && Near(a.diagonal, b.diagonal);
}

}  // namespace arap::cli
