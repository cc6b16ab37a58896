// glTF 2.0 (.gltf, .glb): the surface of all meshes of its scene.
#pragma once

#include <string>
#include <string_view>

#include "arap/base/result.h"
#include "core/files/gltf_document.h"
#include "core/files/surface_file.h"

namespace arap {

// The surface of a glTF file, as JSON or GLB. `name` is what messages call it, `load` reads buffers
// that are files beside it.
//
// Read are the triangles of the scene that the file opens with, of the first one or, without scenes,
// of all nodes; each where the transforms of its nodes put it. The vertices of a mesh keep their
// order; parts of a mesh that share their vertices go on sharing them. Positions are floats or short
// whole numbers (KHR_mesh_quantization). Every node becomes an object
// with its name, or that of its mesh.
//
// Told in warnings and passed over: points and lines, morph targets, skins (a skinned mesh stays as
// it is modelled) and the colours, normals and the like of vertices. Refused by name: triangle strips
// and fans, sparse accessors, compressed data and every other required extension that could change
// the shape. kInvalidOption for these too, and for whatever does not fit together. The memory is
// bounded by the file, also where many nodes show one mesh.
Result<SurfaceFile> ParseGltf(std::string_view bytes, const std::string& name,
                              const LoadBeside& load);

}  // namespace arap
