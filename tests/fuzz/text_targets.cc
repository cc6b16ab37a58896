// Texts that people write for arapctl: tracks, and the lists beside a surface.
#include <cstddef>
#include <string>

#include "client/cli/commands/flatten_inputs.h"
#include "core/files/track.h"
#include "core/files/track_file.h"
#include "tests/fuzz/check.h"
#include "tests/fuzz/memory_cap.h"
#include "tests/fuzz/targets.h"

namespace arap::fuzz {
namespace {

constexpr const char* kName = "a.txt";
constexpr std::size_t kVertices = 100, kTriangles = 4;

// A fault of a text names it.
void CheckFault(const Fault& fault, const char* what) {
  Promise(fault.kind == FaultKind::kInvalidOption && fault.message.starts_with(kName), what);
}

// Places are asked for entries that are there.
void CheckPlace(const std::string& place) {
  Promise(place.starts_with(kName) && !place.ends_with(":0"), "the place of an entry");
}

}  // namespace

void TrackFile(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const Result<arap::Track> track = Capped(size, [&] { return ParseTrack(text, kName); });
  if (!track) return CheckFault(track.error(), "the fault of a track");
  std::size_t targets = 0;
  TrackSegments segments(*track);
  for (std::size_t i = 0; i < track->frames.size(); ++i) {
    const std::size_t handles = segments.At(i).ids.size();
    Promise(track->frames[i].targets.size() == handles, "a target for each handle");
    targets += handles;
  }
  Promise(targets <= 65'536 + size, "not many more targets than the text is long");
  const std::string again = FormatTrack(*track);
  const Result<arap::Track> back = ParseTrack(again, kName);
  Promise(back.has_value() && FormatTrack(*back) == again, "a track is read back");
}

void Lists(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  if (const auto seams = Capped(size, [&] { return cli::ParseSeams(text, kName, kVertices); })) {
    for (const auto& edge : *seams) {
      Promise(edge[0] < kVertices && edge[1] < kVertices, "vertices of a seam");
    }
    if (!seams->empty()) CheckPlace(cli::PlaceOfSeam(text, kName, seams->size() - 1));
  } else {
    CheckFault(seams.error(), "the fault of seams");
  }
  if (const auto pins = Capped(size, [&] { return cli::ParsePins(text, kName, kVertices); })) {
    for (const UvPin& pin : *pins) {
      Promise(pin.vertex < kVertices && pin.weight >= 0, "a pin");
      CheckFinite(pin.uv.real() + pin.uv.imag(), "a pin");
    }
    if (!pins->empty()) CheckPlace(cli::PlaceOfPin(text, kName, pins->size() - 1));
  } else {
    CheckFault(pins.error(), "the fault of pins");
  }
  if (const auto rigidity =
          Capped(size, [&] { return cli::ParseRigidity(text, kName, kTriangles); })) {
    for (const double number : *rigidity) Promise(number > 0 && number <= kMaxRigidity, "rigidity");
    CheckPlace(cli::PlaceOfRigidity(text, kName, kTriangles - 1));
  } else {
    CheckFault(rigidity.error(), "the fault of rigidity");
  }
}

}  // namespace arap::fuzz
