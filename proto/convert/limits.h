// Limits on the wire: the fields of arap.v1.Limits have the names of the table of limits.
#pragma once

#include <arap/v1/server_service.pb.h>

#include "arap/model/limits.h"

namespace arap::convert {

void ToWire(const Limits& limits, v1::Limits* out);

// A limit that the other side does not tell is 0.
Limits FromWire(const v1::Limits& limits);

}  // namespace arap::convert
