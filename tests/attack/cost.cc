// Attacks that ask for work without end, each with a request that is allowed.
#include <string>

#include "tests/attack/attacker.h"
#include "tests/support/surfaces.h"
#include "tests/system/wire/flatten_fixture.h"

namespace arap::attack {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Stub = v1::DeformationService::Stub;

constexpr seconds kPatience{60};  // longer than any attack

// One triangle in every square: the triangles of a planar mesh share vertices and no edges.
v1::PlanarMesh Lattice(int n) {
  v1::PlanarMesh mesh;
  for (int y = 0; y <= n; ++y) {
    for (int x = 0; x <= n; ++x) {
      mesh.add_vertices(x);
      mesh.add_vertices(y);
    }
  }
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const auto corner = static_cast<std::uint32_t>(y * (n + 1) + x);
      for (const std::uint32_t v :
           {corner, corner + 1, corner + static_cast<std::uint32_t>(n) + 1}) {
        mesh.add_triangles(v);
      }
    }
  }
  return mesh;
}

// Frames of 90,000 vertices with a thousand refinements, by callers who give up after a second.
void DeepDeform(Attacker& attacker) {
  Mallory mallory(attacker, 300);
  mallory.Compile("h", mallory.Handles(4));
  attacker.Begin();
  attacker.Loop(3, [&](int) { mallory.Deform("h", 4, 1'000, seconds(1)); });
}

// A hard handle over an area of `radius` squares.
void HardArea(Attacker& attacker) {
  Mallory mallory(attacker, 120);
  attacker.Begin();
  attacker.Loop(2, [&](int i) {
    v1::Handle area = wire::VertexHandle("a", 121 * 60 + 60);
    area.set_hard(true);
    area.set_area_radius(34 + i);
    mallory.Compile("hard" + std::to_string(i), {&area, 1}, kPatience);
  });
}

void LatticeMesh(Attacker& attacker) {
  Mallory mallory(attacker, 2);
  const v1::PlanarMesh mesh = Lattice(140);
  attacker.Begin();
  attacker.Loop(2, [&](int i) {
    v1::RegisterMeshRequest request;
    request.set_session_id("s");
    request.set_mesh_id("lattice" + std::to_string(i));
    *request.mutable_mesh() = mesh;
    const grpc::Status status =
        attacker.Call(mallory.client().deformation(), &v1::DeformationService::Stub::RegisterMesh,
                      request, kPatience);
    if (status.ok()) mallory.Compile("h", mallory.Handles(2), kPatience);
  });
}

// A set of a thousand handles with depths, looked up.
void DepthLookUp(Attacker& attacker) {
  Mallory mallory(attacker, 100);
  auto handles = mallory.Handles(1'000);
  for (std::size_t i = 0; i < handles.size(); ++i) {
    handles[i].set_depth(static_cast<double>(i % 17));
    handles[i].set_depth_falloff(20);
  }
  mallory.Compile("deep", handles, seconds(15));
  attacker.Begin();
  attacker.Loop(4, [&](int) {
    v1::GetHandleSetRequest request;
    request.set_session_id("s");
    request.set_handle_set_id("deep");
    v1::GetHandleSetResponse response;
    grpc::ClientContext context;
    fault::SetDeadline(context, kPatience);
    attacker.Count(mallory.client().deformation().GetHandleSet(&context, request, &response));
  });
}

void ManyPicks(Attacker& attacker) {
  Mallory mallory(attacker, 200);
  mallory.Compile("h", mallory.Handles(4));
  attacker.Begin();
  attacker.Loop(3, [&](int) { mallory.Deform("h", 4, 0, kPatience, 1'024); });
}

// Edits that put the whole set on another footing: one handle becomes heavy, then light again.
void RefactoringEdits(Attacker& attacker) {
  Mallory mallory(attacker, 200);
  const auto handles = mallory.Handles(100);
  mallory.Compile("h0", handles, seconds(15));
  mallory.Compile("h1", handles, seconds(15));
  attacker.Begin();
  attacker.Loop(2, [&](int i) {
    for (int round = 0;; ++round) {
      v1::EditHandlesRequest request;
      request.set_session_id("s");
      request.set_handle_set_id("h" + std::to_string(i));
      request.add_remove("h50");
      v1::Handle handle = handles[50];
      handle.set_hard(round % 2 == 0);
      handle.set_oriented(round % 3 == 0);
      *request.add_add() = handle;
      attacker.Call(mallory.client().deformation(), &v1::DeformationService::Stub::EditHandles,
                    request, kPatience);
    }
  });
}

// A surface of triangles that do not touch: as many charts.
void ManyCharts(Attacker& attacker) {
  constexpr int kTriangles = 60'000;
  v1::FlattenRequest request;
  for (int i = 0; i < kTriangles; ++i) {
    const int column = i % 250, row = i / 250;
    const double x = 2. * column, y = 2. * row;
    for (const double value : {x, y, 0.0, x + 1, y, 0.1 * (i % 7), x, y + 1, 0.0}) {
      request.mutable_mesh()->add_vertices(value);
    }
    for (int k = 0; k < 3; ++k) {
      request.mutable_mesh()->add_triangles(static_cast<std::uint32_t>(3 * i + k));
    }
  }
  fault::FaultClient client(attacker.address(), attacker.token());
  attacker.Begin();
  attacker.Loop(2, [&](int) {
    attacker.Call(client.flattening(), &v1::FlatteningService::Stub::Flatten, request, kPatience);
  });
}

// A layout that is asked to be injective and is hard to make so, with a thousand refinements.
void InjectiveFlatten(Attacker& attacker) {
  v1::FlattenRequest request = wire::RequestFor(testing::SphereCap(100, 160, 3.0));
  request.set_injective(true);
  request.set_refine(1'000);
  request.set_refine_stop(0);
  fault::FaultClient client(attacker.address(), attacker.token());
  attacker.Begin();
  attacker.Loop(2, [&](int) {
    attacker.Call(client.flattening(), &v1::FlatteningService::Stub::Flatten, request, seconds(2));
  });
}

}  // namespace

std::vector<Attack> AttacksByCost() {
  return {
      {"deep-deform", "90,000 vertices refined a thousand times, deadline one second", DeepDeform,
       2'048},
      {"hard-area", "a hard handle over an area of 3,600 vertices", HardArea, 1'024},
      {"lattice-mesh", "20,000 vertices whose triangles share no edge", LatticeMesh, 1'024},
      {"depth-look-up", "a set of 1,000 handles with depths, looked up again and again",
       DepthLookUp, 1'024},
      {"many-picks", "frames with 1,024 points to pick", ManyPicks, 1'024},
      {"refactoring-edits", "edits of one handle of a hundred that factor anew", RefactoringEdits,
       1'024},
      {"many-charts", "a surface of 60,000 triangles apart", ManyCharts, 1'024},
      {"injective-flatten", "a layout that is hard to make injective, refined a thousand times",
       InjectiveFlatten, 1'024},
  };
}

}  // namespace arap::attack
