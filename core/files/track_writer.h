// The text of a track, TRACK.json (track_file.h says what stands in it).
#pragma once

#include <string>

#include "core/files/track.h"

namespace arap {

// ParseTrack reads it back exactly. Every frame has all targets, also those that were kept.
std::string FormatTrack(const Track& track);

}  // namespace arap
