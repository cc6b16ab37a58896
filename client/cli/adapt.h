// Between the values of the model and those of the client library, which come in flat arrays.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "arap/client/flatten.h"
#include "arap/client/handles.h"
#include "arap/client/mesh.h"
#include "arap/client/shape.h"
#include "arap/model/flatten.h"
#include "arap/model/handle.h"
#include "arap/model/mesh.h"

namespace arap::cli {

// x y x y… to points, and back. An odd number at the end is dropped.
inline std::vector<Complex> ToPoints(std::span<const double> flat) {
  std::vector<Complex> points;
  points.reserve(flat.size() / 2);
  for (std::size_t i = 0; i + 1 < flat.size(); i += 2) points.emplace_back(flat[i], flat[i + 1]);
  return points;
}
inline std::vector<double> ToFlat(std::span<const Complex> points) {
  std::vector<double> flat;
  flat.reserve(2 * points.size());
  for (const Complex p : points) flat.insert(flat.end(), {p.real(), p.imag()});
  return flat;
}

// Rows of N, and back.
template <std::size_t N, class T>
std::vector<std::array<T, N>> ToRows(const std::vector<T>& flat) {
  std::vector<std::array<T, N>> rows(flat.size() / N);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::copy_n(flat.begin() + static_cast<std::ptrdiff_t>(N * i), N, rows[i].begin());
  }
  return rows;
}
template <std::size_t N, class T>
std::vector<T> ToFlat(const std::vector<std::array<T, N>>& rows) {
  std::vector<T> flat;
  flat.reserve(N * rows.size());
  for (const auto& row : rows) flat.insert(flat.end(), row.begin(), row.end());
  return flat;
}

inline PlanarMesh ToModel(const client::PlanarMesh& mesh) {
  return {ToPoints(mesh.vertices), ToRows<3>(mesh.triangles)};
}
inline SurfaceMesh ToModel(const client::SurfaceMesh& mesh) {
  return {ToRows<3>(mesh.vertices), ToRows<3>(mesh.triangles)};
}
inline client::PlanarMesh ToClient(const PlanarMesh& mesh) {
  return {ToFlat(mesh.vertices), ToFlat(mesh.triangles)};
}
inline client::SurfaceMesh ToClient(const SurfaceMesh& mesh) {
  return {ToFlat(mesh.vertices), ToFlat(mesh.triangles)};
}

inline client::Handle ToClient(const Handle& handle) {
  client::Handle out;
  out.id = handle.id;
  if (const auto* vertex = std::get_if<VertexAnchor>(&handle.anchor)) {
    out.anchor = client::VertexAnchor{vertex->vertex};
  } else if (const auto* triangle = std::get_if<TriangleAnchor>(&handle.anchor)) {
    out.anchor = client::TriangleAnchor{triangle->triangle, triangle->barycentric};
  } else {
    const Complex at = std::get<PointAnchor>(handle.anchor).position;
    out.anchor = client::PointAnchor{at.real(), at.imag()};
  }
  out.weight = handle.weight;
  out.hard = handle.hard;
  out.oriented = handle.oriented;
  out.area_radius = handle.area_radius;
  out.snap = handle.outside == Outside::kSnap;
  out.depth = handle.depth;
  out.depth_falloff = handle.depth_falloff;
  return out;
}
inline std::vector<client::Handle> ToClient(std::span<const Handle> handles) {
  std::vector<client::Handle> out;
  for (const Handle& handle : handles) out.push_back(ToClient(handle));
  return out;
}

inline client::HandleTarget ToClient(std::string id, const Target& target) {
  return {std::move(id), target.position.real(), target.position.imag(), target.angle,
          target.scale};
}
// A frame of a track. Angles and scales only where one differs from the rest pose.
inline client::TrackFrame ToClient(std::span<const Target> targets) {
  client::TrackFrame frame;
  for (const Target& target : targets) {
    frame.positions.insert(frame.positions.end(), {target.position.real(), target.position.imag()});
  }
  const auto any = [&](auto differs) {
    return std::any_of(targets.begin(), targets.end(), differs);
  };
  if (any([](const Target& target) { return target.angle != 0; })) {
    for (const Target& target : targets) frame.angles_radians.push_back(target.angle);
  }
  if (any([](const Target& target) { return target.scale != 1; })) {
    for (const Target& target : targets) frame.scales.push_back(target.scale);
  }
  return frame;
}

inline GrainLine ToModel(const client::GrainLine& line) {
  return {line.from_vertex, line.to_vertex, line.angle_degrees * std::numbers::pi / 180};
}

inline Distortion ToModel(const client::Distortion& d) {
  return {.arap_energy = d.arap_energy,
          .symmetric_dirichlet = d.symmetric_dirichlet,
          .area_ratio = d.area_ratio,
          .mean_stretch_percent = d.mean_stretch_percent,
          .max_stretch_percent = d.max_stretch_percent,
          .mean_compression_percent = d.mean_compression_percent,
          .max_compression_percent = d.max_compression_percent,
          .mean_angle_degrees = d.mean_angle_degrees,
          .max_angle_degrees = d.max_angle_degrees,
          .flipped = d.flipped,
          .worst_triangle = d.worst_triangle};
}
inline Flattening ToModel(const client::FlatSurface& flat) {
  Flattening out;
  out.uv = ToPoints(flat.uv);
  out.source = flat.uv_vertex;
  out.corner_uv = ToRows<3>(flat.corner_uv);
  out.triangle_chart = flat.triangle_chart;
  for (const client::FlatChart& chart : flat.charts) {
    out.charts.push_back({.loops = chart.loops,
                          .anchors = chart.anchors,
                          .triangles = chart.triangle_count,
                          .distortion = ToModel(chart.distortion),
                          .crossings = chart.boundary_crossings,
                          .refinements = static_cast<int>(chart.refinements)});
  }
  out.first_step = ToPoints(flat.first_step_uv);
  out.singular_values = ToRows<2>(flat.singular_values);
  out.distortion = ToModel(flat.distortion);
  out.overlaps = flat.boundary_overlaps;
  out.cuts = ToRows<2>(flat.cut_edges);
  out.auto_cuts = flat.auto_cut_count;
  out.degenerate = flat.left_out_triangles;
  for (const client::Warning& warning : flat.warnings) {
    out.warnings.push_back({warning.kind, warning.count, warning.elements, warning.message});
  }
  return out;
}

}  // namespace arap::cli
