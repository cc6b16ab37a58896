// Meshes and their registration. Nothing is checked on this side: the server checks, and names what
// is wrong.
#pragma once

#include <optional>
#include <string>

#include "arap/model/energy.h"
#include "arap/model/mesh.h"
#include "arap/model/outline.h"
#include "arap/model/repair.h"

namespace arap::client {

using arap::Basis;
using arap::Complex;
using arap::EnergyOptions;
using arap::Outline;
using arap::OutlineOptions;
using arap::PlanarMesh;
using arap::Point3;
using arap::QualityMesh;
using arap::RegistrationReport;
using arap::RepairOptions;
using arap::SurfaceMesh;
using arap::Triangle;
using arap::Warning;
using arap::Weights;

// A mesh as a session holds it.
struct MeshInfo {
  std::string id;
  // SHA-256 of the mesh and its options, in hexadecimal; equal meshes share their factors.
  std::string content_hash;
  // Counts, sizes and warnings; clamped_weights is 0, for a warning tells of them.
  RegistrationReport report;
  // In force, without the rigidity. Empty for options of a newer server that this version has no
  // name for.
  std::optional<EnergyOptions> energy;
  RepairOptions repairs;  // in force
};

// The answer to RegisterMesh.
struct Registration {
  MeshInfo mesh;
  bool shared = false;      // whether the factors were there already
  double queue_micros = 0;  // time spent waiting for a worker
  double solve_micros = 0;  // time spent computing
};

// The answer to MeshOutline.
struct OutlineMesh {
  QualityMesh triangles;
  double queue_micros = 0;  // time spent waiting for a worker
  double solve_micros = 0;  // time spent computing
};

}  // namespace arap::client
