// Whether what a server answered fits what it was asked: nothing of an answer is used before.
#pragma once

#include <cstddef>

#include "arap/base/result.h"
#include "arap/client/flatten.h"
#include "arap/client/shape.h"

namespace arap::cli {

// kInternal unless the shape has so many positions, all of them finite.
Status CheckShape(const client::Shape& shape, std::size_t vertices);

// kInternal unless every length, index and number of the layout is as model/flatten.h says for this
// mesh, with singular values.
Status CheckLayout(const Flattening& flat, const SurfaceMesh& mesh);

}  // namespace arap::cli
