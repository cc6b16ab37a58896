// The answers of the server as the client library shows them: the model's values, which
// proto/convert knows, with what is of the wire only.
#pragma once

#include "arap/base/result.h"
#include "arap/client/client.h"

namespace arap::v1 {
class DeformOptions;
class GetServerInfoResponse;
class HandleSetInfo;
class MeshInfo;
class Session;
class Shape;
}  // namespace arap::v1

namespace arap::client::internal {

void ToWire(const ShapeOptions& options, v1::DeformOptions* out);

MeshInfo FromWire(const v1::MeshInfo& mesh);
HandleSetInfo FromWire(const v1::HandleSetInfo& set);
// kInternal for positions of a wrong length.
Result<Shape> FromWire(const v1::Shape& shape);

SessionInfo FromWire(const v1::Session& session);
ServerInfo FromWire(const v1::GetServerInfoResponse& response);

}  // namespace arap::client::internal
