// Positions of deformed shapes between the model and the wire, in every encoding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/encoding.h"
#include "arap/model/mesh.h"

namespace arap::v1 {
class DeformOptions;
class Shape;
}  // namespace arap::v1

namespace arap::convert {

// What positions are asked to be written as.
struct PositionFormat {
  bool float64 = false;
  bool relative = false;  // to an origin that the shape states; not with float64
  PositionEncoding encoding = PositionEncoding::kFloat32;
};

// kInvalidOption: an encoding that this version does not know, or one beside float64.
Result<PositionFormat> FormatFromWire(const v1::DeformOptions& options);
void ToWire(const PositionFormat& format, v1::DeformOptions* out);

// The vertices that options ask for, of a mesh with so many; none stand for all. Faults with fields
// under "options.vertex_subset": kArrayLength (more than there are), kIndexOutOfRange,
// kRepeatedIndex; kInvalidOption when the boundary is asked for too.
Result<std::vector<std::uint32_t>> SubsetFromWire(const v1::DeformOptions& options,
                                                  std::size_t vertex_count);

// Positions into a cleared `out`. kNumerical when one does not fit the format; nothing is written then.
Status ToWire(std::span<const Complex> positions, const PositionFormat& format, v1::Shape* out);

// Positions as they were read.
struct ReadPositions {
  std::vector<Complex> positions;
  double error = 0;  // how far each coordinate may be off because of the format; 0 with float64
};

// In the format that was asked for, with the origin added. Floats without an origin are taken as they are:
// a server of before knows none. kInternal for what no server of ours answers.
Result<ReadPositions> PositionsFromWire(const v1::Shape& shape, const PositionFormat& format);

}  // namespace arap::convert
