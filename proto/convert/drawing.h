// Drawings of layouts between the model and the wire.
#pragma once

#include <vector>

#include "arap/base/result.h"
#include "arap/model/drawing.h"

namespace arap::v1 {
class FlattenRequest;
class FlattenResponse;
}  // namespace arap::v1

namespace arap::convert {

// What is asked for; numbers are for core/drawing to judge. kInvalidOption for more than
// kMaxDrawings, and for a format or corners that this version does not know.
Result<std::vector<DrawingOptions>> DrawingsFromWire(const v1::FlattenRequest& request);
std::vector<NamedPart> PartsFromWire(const v1::FlattenRequest& request);
void ToWire(const std::vector<DrawingOptions>& drawings, const std::vector<NamedPart>& parts,
            v1::FlattenRequest* out);

std::vector<Drawing> DrawingsFromWire(const v1::FlattenResponse& response);
// Takes the bytes of the files.
void ToWire(std::vector<Drawing> drawings, v1::FlattenResponse* out);

}  // namespace arap::convert
