// Between the plain structs and the wire. Nothing is checked: the server checks.
#pragma once

#include <chrono>
#include <span>
#include <string>
#include <vector>

#include <google/protobuf/repeated_field.h>

#include "arap/client/client.h"
#include "arap/v1/deformation_service.pb.h"
#include "arap/v1/flattening_service.pb.h"
#include "arap/v1/server_service.pb.h"

namespace arap::client::internal {

template <class Message, class T>
void Append(std::span<const T> from, google::protobuf::RepeatedField<Message>* to) {
  to->Add(from.begin(), from.end());
}

template <class To, class From>
std::vector<To> Values(const google::protobuf::RepeatedField<From>& from) {
  return std::vector<To>(from.begin(), from.end());
}

std::chrono::nanoseconds FromWire(const google::protobuf::Duration& duration);
double Micros(const google::protobuf::Duration& duration);
void ToWire(std::chrono::nanoseconds duration, google::protobuf::Duration* out);

// Meshes.
void ToWire(const PlanarMesh& mesh, v1::PlanarMesh* out);
void ToWire(const SurfaceMesh& mesh, v1::SurfaceMesh* out);
void ToWire(const EnergyOptions& energy, v1::EnergyOptions* out);
EnergyOptions FromWire(const v1::EnergyOptions& energy);
std::vector<Warning> FromWire(const google::protobuf::RepeatedPtrField<v1::Warning>& warnings);
MeshInfo FromWire(const v1::MeshInfo& mesh);

// Handles.
void ToWire(const Handle& handle, v1::Handle* out);
void ToWire(const HandleTarget& target, v1::HandleTarget* out);
HandleSetInfo FromWire(const v1::HandleSetInfo& set);

// Shapes.
void ToWire(const DeformOptions& options, v1::DeformOptions* out);
Shape FromWire(const v1::Shape& shape);

// Surfaces.
void ToWire(const FlattenOptions& options, v1::FlattenRequest* out);
FlatSurface FromWire(const v1::FlattenResponse& response);

// Sessions, servers.
SessionInfo FromWire(const v1::Session& session);
ServerInfo FromWire(const v1::GetServerInfoResponse& response);

}  // namespace arap::client::internal
