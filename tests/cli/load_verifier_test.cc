// What was computed here too: right answers of a server are found right, and others are not.
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "client/cli/connect/connection.h"
#include "client/cli/load/load_session.h"
#include "client/cli/load/verifier.h"

namespace arap::cli {
namespace {

TEST(Verifier, KnowsRightFromWrong) {
  ServerFlags flags;
  flags.spawn = true;
  const auto connection = Connection::Open(flags);
  ASSERT_TRUE(connection) << connection.error().message;
  const client::Client& client = connection->client();
  const LoadScene scene = MakeLoadScene(30, 3);
  auto verifier = Verifier::Open(client, scene);
  ASSERT_TRUE(verifier) << verifier.error().message;

  const auto session = client.CreateSession();
  ASSERT_TRUE(session);
  const std::vector<Complex> targets = TargetsOf(scene, 1, 2, 3),
                             before = TargetsOf(scene, 1, 2, 1);
  const auto registered = session->RegisterMesh(scene.mesh, {});
  ASSERT_TRUE(registered);
  ASSERT_TRUE(session->CompileHandles(kLoadSet, registered->mesh.id, scene.handles));
  std::vector<HandleTarget> named;
  for (std::size_t k = 0; k < targets.size(); ++k)
    named.push_back({scene.handles[k].id, {targets[k]}});
  const auto shape = session->Deform(kLoadSet, named);
  ASSERT_TRUE(shape);
  auto flat = client.Flatten(scene.surface);
  ASSERT_TRUE(flat);
  PlanarMesh larger = scene.mesh;
  for (Complex& p : larger.vertices) p *= 1.5;
  const auto scaled = session->RegisterMesh(larger, {});
  ASSERT_TRUE(scaled);

  client::Shape off = *shape;
  off.positions[5] += 0.01;
  std::vector<Complex> moved = flat->flat.uv;
  moved[5] += 0.01;
  client::MeshInfo other = scaled->mesh;
  ++other.report.edges;
  const std::vector<std::pair<bool, std::function<void(Verifier::Told)>>> cases{
      {true, [&](auto told) { (*verifier)->AskShape({.targets = targets}, *shape, told); }},
      {false, [&](auto told) { (*verifier)->AskShape({.targets = before}, *shape, told); }},
      {false, [&](auto told) { (*verifier)->AskShape({.targets = targets}, off, told); }},
      {false,
       [&](auto told) {
         (*verifier)->AskShape({.targets = targets, .extra_since = before}, *shape, told);
       }},
      {true, [&](auto told) { (*verifier)->AskFlat(flat->flat.uv, told); }},
      {false, [&](auto told) { (*verifier)->AskFlat(moved, told); }},
      {false, [&](auto told) { (*verifier)->AskFlat({}, told); }},
      {true, [&](auto told) { (*verifier)->AskMesh(1.5, scaled->mesh, told); }},
      {false, [&](auto told) { (*verifier)->AskMesh(1.25, scaled->mesh, told); }},
      {false, [&](auto told) { (*verifier)->AskMesh(1.5, other, told); }},
      {true, [&](auto told) { (*verifier)->AskMesh(1, registered->mesh, told); }},
      {true, [&](auto told) { (*verifier)->AskShape({.targets = targets}, *shape, told); }},
  };
  std::vector<std::string> said(cases.size(), "nothing");
  for (std::size_t i = 0; i < cases.size(); ++i) {
    cases[i].second([&said, i](const Result<bool>& right) {
      said[i] = !right ? right.error().message : *right ? "right" : "wrong";
    });
  }
  (*verifier)->AwaitAnswers();
  for (std::size_t i = 0; i < cases.size(); ++i) {
    EXPECT_EQ(said[i], cases[i].first ? "right" : "wrong") << "case " << i;
  }
}

}  // namespace
}  // namespace arap::cli
