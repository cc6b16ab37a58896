// The fuzz targets: functions from any bytes to nothing. See script/fuzz.
#pragma once

#include <cstddef>
#include <cstdint>

namespace arap::fuzz {

// Up to eight calls of one family, each: one byte that chooses the method, with its highest bit set
// to fill in the session, mesh and set that exist; the length of the request in two bytes; the
// request as on the wire. Handled without sockets by the handlers of server/rpc; where the answer
// comes in pieces, over a channel within the process.
void Session(const std::uint8_t* data, std::size_t size);
void Mesh(const std::uint8_t* data, std::size_t size);
void Handles(const std::uint8_t* data, std::size_t size);
void Deform(const std::uint8_t* data, std::size_t size);
void Flatten(const std::uint8_t* data, std::size_t size);
void Server(const std::uint8_t* data, std::size_t size);

// The messages of one StreamDeform, each with its length, over a channel within the process.
void Stream(const std::uint8_t* data, std::size_t size);
// One DeformTrack over the same channel.
void Track(const std::uint8_t* data, std::size_t size);

// The core alone, from bytes with a structure: registration, handles, edits, updates and picks; and
// flattening with every option.
void CoreDeform(const std::uint8_t* data, std::size_t size);
void CoreFlatten(const std::uint8_t* data, std::size_t size);

// Mesh files, read; written with a layout, and read again.
void Obj(const std::uint8_t* data, std::size_t size);
void Off(const std::uint8_t* data, std::size_t size);
void Stl(const std::uint8_t* data, std::size_t size);
void Ply(const std::uint8_t* data, std::size_t size);
void Gltf(const std::uint8_t* data, std::size_t size);
// What gzip has packed.
void Gzip(const std::uint8_t* data, std::size_t size);

// The rules of a stream without the wire: messages, ends of jobs and writes, and time in any order.
void Policy(const std::uint8_t* data, std::size_t size);

// Texts of arapctl: TRACK.json; and one that is read as seams, as pins and as rigidity.
void TrackFile(const std::uint8_t* data, std::size_t size);
void Lists(const std::uint8_t* data, std::size_t size);

struct FuzzTarget {
  const char* name;  // of the corpus too
  void (*run)(const std::uint8_t* data, std::size_t size);
};

inline constexpr FuzzTarget kTargets[] = {
    {"session", Session},
    {"mesh", Mesh},
    {"handles", Handles},
    {"deform", Deform},
    {"flatten", Flatten},
    {"server", Server},
    {"stream", Stream},
    {"track", Track},
    {"core_deform", CoreDeform},
    {"core_flatten", CoreFlatten},
    {"policy", Policy},
    {"track_file", TrackFile},
    {"lists", Lists},
    {"obj", Obj},
    {"off", Off},
    {"stl", Stl},
    {"ply", Ply},
    {"gltf", Gltf},
    {"gzip", Gzip},
};

}  // namespace arap::fuzz
