#include "proto/convert/positions.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include <arap/v1/deformation_service.pb.h>
#include <fmt/format.h>

#include "core/base/try.h"
#include "proto/convert/plain.h"

namespace arap::convert {
namespace {

constexpr double kLargest = std::numeric_limits<double>::max();

constexpr EnumRow<v1::PositionEncoding, PositionEncoding> kEncodings[] = {
    {v1::POSITION_ENCODING_FLOAT32, PositionEncoding::kFloat32},
    {v1::POSITION_ENCODING_FLOAT32_LE, PositionEncoding::kFloat32Le},
    {v1::POSITION_ENCODING_INT16_LE, PositionEncoding::kInt16Le},
};
static_assert(std::size(kEncodings) == v1::PositionEncoding_ARRAYSIZE - 1);

auto Unfit() {
  return Fail(FaultKind::kNumerical, "A position of the result is not finite in this precision.");
}

auto Bad(const char* sentence) { return Fail(FaultKind::kInternal, sentence); }

// The box around points; NaN is in none.
struct Box {
  Complex middle;
  double half = 0;  // of the longer side
};

// kNumerical when one is so far away that what is near it may not be a number.
Result<Box> BoxAround(std::span<const Complex> points) {
  double left = kLargest, right = -kLargest, bottom = kLargest, top = -kLargest;
  for (const Complex& point : points) {
    left = std::min(left, point.real());
    right = std::max(right, point.real());
    bottom = std::min(bottom, point.imag());
    top = std::max(top, point.imag());
  }
  if (points.empty()) return Box{};
  const double farthest = std::max({-left, right, -bottom, top});
  if (!(farthest <= kLargest / 4)) return Unfit();
  return Box{{(left + right) / 2, (bottom + top) / 2}, std::max(right - left, top - bottom) / 2};
}

void SetOrigin(Complex origin, v1::Shape* out) {
  out->add_origin(origin.real());
  out->add_origin(origin.imag());
}

// Little-endian, whatever this machine is.
template <class Unsigned>
Unsigned Turned(Unsigned value) {
  if constexpr (std::endian::native == std::endian::little) {
    return value;
  } else {
    Unsigned turned = 0;
    for (std::size_t i = 0; i < sizeof(value); ++i) {
      turned = static_cast<Unsigned>((turned << 8u) | (value >> (8 * i) & 0xffu));
    }
    return turned;
  }
}

template <class Unsigned>
char* Put(Unsigned value, char* out) {
  value = Turned(value);
  std::memcpy(out, &value, sizeof(value));
  return out + sizeof(value);
}

template <class Unsigned>
Unsigned Take(const char* in) {
  Unsigned value = 0;
  std::memcpy(&value, in, sizeof(value));
  return Turned(value);
}

char* PutFloat(double value, char* out) {
  return Put(std::bit_cast<std::uint32_t>(static_cast<float>(value)), out);
}

Status WriteFloats(std::span<const Complex> points, Complex origin, std::string* out) {
  constexpr auto kLargestFloat = static_cast<double>(std::numeric_limits<float>::max());
  out->resize(2 * sizeof(float) * points.size());
  char* next = out->data();
  const double x0 = origin.real(), y0 = origin.imag();
  for (const Complex& point : points) {
    const double x = point.real() - x0, y = point.imag() - y0;
    // Written so that NaN fails too.
    if (!(std::abs(x) <= kLargestFloat && std::abs(y) <= kLargestFloat)) return Unfit();
    next = PutFloat(y, PutFloat(x, next));
  }
  return {};
}

// The nearest integer of a number that is finite and, but for rounding, at most kInt16Steps.
char* PutStep(double steps, char* out) {
  constexpr double kMost = kInt16Steps;
  // A conversion cuts off, so what it gets is positive; that is quicker than to call for a rounding.
  const int whole = static_cast<int>(std::clamp(steps, -kMost, kMost) + (kMost + 0.5));
  return Put(static_cast<std::uint16_t>(whole - kInt16Steps), out);
}

Status WriteSteps(std::span<const Complex> points, v1::Shape* out) {
  TRY(const Box box, BoxAround(points));
  const double scale = box.half / kInt16Steps;
  std::string& bytes = *out->mutable_packed_positions();
  bytes.assign(2 * sizeof(std::int16_t) * points.size(), '\0');
  char* next = bytes.data();
  const double x0 = box.middle.real(), y0 = box.middle.imag();
  for (const Complex& point : points) {
    const double x = point.real() - x0, y = point.imag() - y0;
    if (!std::isfinite(x) || !std::isfinite(y)) return Unfit();
    if (scale == 0) continue;
    next = PutStep(y / scale, PutStep(x / scale, next));
  }
  SetOrigin(box.middle, out);
  out->set_scale(scale);
  return {};
}

Status WriteAll(std::span<const Complex> positions, const PositionFormat& format, v1::Shape* out) {
  if (format.float64) return PackPoints(positions, out->mutable_positions64());
  if (format.encoding == PositionEncoding::kInt16Le) return WriteSteps(positions, out);
  Complex origin;
  if (format.relative) {
    TRY(const Box box, BoxAround(positions));
    origin = box.middle;
    SetOrigin(origin, out);
  }
  if (format.encoding == PositionEncoding::kFloat32Le) {
    return WriteFloats(positions, origin, out->mutable_packed_positions());
  }
  return PackPoints(positions, out->mutable_positions(), origin);
}

// What is read of either kind of floats: `floats` numbers, the i-th of which is at(i).
template <class At>
ReadPositions AddOrigin(std::size_t floats, Complex origin, const At& at) {
  ReadPositions read;
  read.positions.resize(floats / 2);
  const double x0 = origin.real(), y0 = origin.imag();
  double farthest = 0;
  for (std::size_t i = 0; i < read.positions.size(); ++i) {
    const auto x = static_cast<double>(at(2 * i)), y = static_cast<double>(at(2 * i + 1));
    farthest = std::max({farthest, std::abs(x), std::abs(y)});
    read.positions[i] = {x0 + x, y0 + y};
  }
  read.error = farthest * static_cast<double>(std::numeric_limits<float>::epsilon()) / 2;
  return read;
}

Result<ReadPositions> ReadSteps(const std::string& bytes, Complex origin, double scale) {
  if (bytes.size() % 4 != 0) return Bad("The server answered half a position.");
  if (!(scale >= 0 && scale <= kLargest)) {
    return Bad("The server answered integers with a scale that is none.");
  }
  ReadPositions read;
  read.positions.reserve(bytes.size() / 4);
  const auto at = [&](std::size_t i) {
    return static_cast<double>(static_cast<std::int16_t>(Take<std::uint16_t>(&bytes[2 * i])));
  };
  for (std::size_t i = 0; i < bytes.size() / 2; i += 2) {
    read.positions.emplace_back(origin.real() + scale * at(i), origin.imag() + scale * at(i + 1));
  }
  read.error = scale / 2;
  return read;
}

}  // namespace

Result<PositionFormat> FormatFromWire(const v1::DeformOptions& options) {
  PositionFormat format{options.float64(), options.relative_to_origin()};
  TRY(format.encoding,
      ModelOf(kEncodings, options.encoding(), PositionEncoding::kFloat32, "options.encoding"));
  if (format.float64 && options.encoding() != v1::POSITION_ENCODING_UNSPECIFIED) {
    return Fail(Fault(FaultKind::kInvalidOption,
                      "options.encoding says how 32-bit positions travel; with options.float64 "
                      "there are none.")
                    .Field("options.encoding"));
  }
  return format;
}

void ToWire(const PositionFormat& format, v1::DeformOptions* out) {
  out->set_float64(format.float64);
  out->set_relative_to_origin(format.relative);
  // The default is left out, which servers of before understand.
  if (format.encoding != PositionEncoding::kFloat32) {
    out->set_encoding(WireOf(kEncodings, format.encoding));
  }
}

Result<std::vector<std::uint32_t>> SubsetFromWire(const v1::DeformOptions& options,
                                                  std::size_t vertex_count) {
  constexpr const char* kField = "options.vertex_subset";
  const auto& subset = options.vertex_subset();
  const auto count = static_cast<std::size_t>(subset.size());
  if (count > 0 && options.boundary_only()) {
    return Fail(Fault(FaultKind::kInvalidOption,
                      "Either options.boundary_only or options.vertex_subset says which vertices, "
                      "not both.")
                    .Field(kField));
  }
  if (count > vertex_count) {
    return Fail(Fault(FaultKind::kArrayLength,
                      fmt::format("{} has {} entries, more than the {} vertices of the mesh.",
                                  kField, count, vertex_count))
                    .Field(kField)
                    .Detail("length", count)
                    .Detail("limit", vertex_count));
  }
  std::vector<bool> seen(count > 0 ? vertex_count : 0, false);
  for (int i = 0; i < subset.size(); ++i) {
    const std::uint32_t v = subset[i];
    const bool there = v < vertex_count;
    if (there && !seen[v]) {
      seen[v] = true;
      continue;
    }
    const std::string entry = fmt::format("{}[{}]", kField, i);
    return Fail(Fault(there ? FaultKind::kRepeatedIndex : FaultKind::kIndexOutOfRange,
                      there ? fmt::format("{} names vertex {} again.", entry, v)
                            : fmt::format("{} names vertex {}, but the mesh has {} vertices.",
                                          entry, v, vertex_count))
                    .Field(entry)
                    .Element(v)
                    .Detail("limit", vertex_count));
  }
  return Values<std::uint32_t>(subset);
}

Status ToWire(std::span<const Complex> positions, const PositionFormat& format, v1::Shape* out) {
  Status written = WriteAll(positions, format, out);
  if (!written) {
    out->clear_origin();
    out->clear_packed_positions();
  }
  return written;
}

Result<ReadPositions> PositionsFromWire(const v1::Shape& shape, const PositionFormat& format) {
  const bool bytes = !format.float64 && format.encoding != PositionEncoding::kFloat32;
  const bool floats = !format.float64 && !bytes;
  if ((shape.positions_size() > 0 && !floats) ||
      (shape.positions64_size() > 0 && !format.float64) ||
      (!shape.packed_positions().empty() && !bytes)) {
    return Bad("The server answered a shape in another precision than was asked.");
  }
  if (shape.positions_size() % 2 != 0 || shape.positions64_size() % 2 != 0) {
    return Bad("The server answered half a position.");
  }
  const bool relative = shape.origin_size() > 0;
  if (relative && (shape.origin_size() != 2 || format.float64)) {
    return Bad("The server answered an origin that is none.");
  }
  const Complex origin = relative ? Complex(shape.origin(0), shape.origin(1)) : Complex();
  if (format.float64) return ReadPositions{Points(shape.positions64())};
  if (floats) {
    const float* const numbers = shape.positions().data();
    return AddOrigin(static_cast<std::size_t>(shape.positions_size()), origin,
                     [numbers](std::size_t i) { return numbers[i]; });
  }
  const std::string& packed = shape.packed_positions();
  if (format.encoding == PositionEncoding::kInt16Le) {
    if (!relative) return Bad("The server answered integers without an origin.");
    return ReadSteps(packed, origin, shape.scale());
  }
  if (packed.size() % (2 * sizeof(float)) != 0) return Bad("The server answered half a position.");
  return AddOrigin(packed.size() / sizeof(float), origin, [&](std::size_t i) {
    return std::bit_cast<float>(Take<std::uint32_t>(&packed[sizeof(float) * i]));
  });
}

}  // namespace arap::convert
