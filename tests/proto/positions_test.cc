// Positions in every encoding: what is written, what is read, and how far that may be off.
#include "proto/convert/positions.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <arap/v1/deformation_service.pb.h>
#include <gmock/gmock.h>

namespace arap::convert {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr double kFloatLargest = static_cast<double>(std::numeric_limits<float>::max());
constexpr double kLargest = std::numeric_limits<double>::max();
constexpr PositionFormat kFloat64{true, false};
constexpr PositionFormat kFloats{false, false};
constexpr PositionFormat kRelative{false, true};
constexpr PositionFormat kFloatBytes{false, true, PositionEncoding::kFloat32Le};
constexpr PositionFormat kIntegers{false, false, PositionEncoding::kInt16Le};

v1::Shape Written(const std::vector<Complex>& positions, const PositionFormat& format) {
  v1::Shape shape;
  const Status written = ToWire(positions, format, &shape);
  EXPECT_TRUE(written) << written.error().message;
  return shape;
}

// The largest distance along an axis.
double Off(const std::vector<Complex>& a, const std::vector<Complex>& b) {
  EXPECT_EQ(a.size(), b.size());
  double off = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    off = std::max({off, std::abs(a[i].real() - b[i].real()), std::abs(a[i].imag() - b[i].imag())});
  }
  return off;
}

TEST(Positions, FloatsAreTheNumbersUnlessAnOriginIsAskedFor) {
  const std::vector<Complex> positions{{1, 2}, {0.1, -4}};
  const v1::Shape exact = Written(positions, kFloat64);
  EXPECT_EQ(PositionsFromWire(exact, kFloat64)->positions, positions);
  EXPECT_EQ(PositionsFromWire(exact, kFloat64)->error, 0);
  const v1::Shape floats = Written(positions, kFloats);
  EXPECT_THAT(floats.positions(), ElementsAre(1.0F, 2.0F, 0.1F, -4.0F));
  EXPECT_THAT(floats.origin(), IsEmpty());
  EXPECT_EQ(PositionsFromWire(floats, kFloats)->positions[1], Complex(0.1F, -4));
  // What a server answers that has never heard of origins.
  EXPECT_EQ(PositionsFromWire(floats, kRelative)->positions[1], Complex(0.1F, -4));
  const v1::Shape relative = Written({{1, 2}, {3, -4}}, kRelative);
  EXPECT_THAT(relative.origin(), ElementsAre(2, -1));
  EXPECT_THAT(relative.positions(), ElementsAre(-1.0F, 3.0F, 1.0F, -3.0F));
}

TEST(Positions, BytesAreLittleEndian) {
  const v1::Shape floats = Written({{-1, 3}, {1, -3}}, kFloatBytes);
  EXPECT_THAT(floats.origin(), ElementsAre(0, 0));
  EXPECT_EQ(floats.packed_positions(), std::string("\x00\x00\x80\xbf\x00\x00\x40\x40"
                                                   "\x00\x00\x80\x3f\x00\x00\x40\xc0",
                                                   16));
  const v1::Shape integers = Written({{-1, 3}, {1, -3}}, kIntegers);
  EXPECT_EQ(integers.scale(), 3.0 / 32767);
  EXPECT_THAT(integers.origin(), ElementsAre(0, 0));
  // -32767/3 = -10922.33 is d556, 32767 is 7fff.
  EXPECT_EQ(integers.packed_positions(), std::string("\x56\xd5\xff\x7f\xaa\x2a\x01\x80", 8));
}

TEST(Positions, AreReadBackWithinWhatTheyTell) {
  for (const Complex at : {Complex(0, 0), Complex(5e5, 5.4e6), Complex(-1e12, 3e-7)}) {
    for (const double size : {1e-3, 1.0, 1e4}) {
      std::vector<Complex> positions;
      for (int i = 0; i < 500; ++i) {
        positions.push_back(at + size * Complex(std::sin(1.7 * i), std::cos(2.9 * i * i)));
      }
      // Of doubles so far away.
      const double rounding = 4e-16 * (std::abs(at) + size);
      for (const PositionFormat& format : {kFloat64, kRelative, kFloatBytes, kIntegers}) {
        const auto read = PositionsFromWire(Written(positions, format), format);
        ASSERT_TRUE(read) << read.error().message;
        EXPECT_LE(Off(read->positions, positions), read->error + rounding);
        const bool integers = format.encoding == PositionEncoding::kInt16Le;
        EXPECT_LE(read->error, size * (integers ? 1.6e-5 : 6.1e-8) + rounding);
      }
      const auto plain = PositionsFromWire(Written(positions, kFloats), kFloats);
      EXPECT_LE(Off(plain->positions, positions), plain->error + rounding);
    }
  }
}

TEST(Positions, OfOnePlaceAndOfNone) {
  for (const PositionFormat& format : {kFloat64, kFloats, kRelative, kFloatBytes, kIntegers}) {
    const std::vector<Complex> one{{3, 4}, {3, 4}};
    EXPECT_EQ(PositionsFromWire(Written(one, format), format)->positions, one);
    EXPECT_THAT(PositionsFromWire(Written({}, format), format)->positions, IsEmpty());
  }
}

TEST(Positions, WhatDoesNotFitIsNumerical) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Complex> far{{1e39, 0}, {1e39, 0}};
  const std::vector<Complex> wide{{-kFloatLargest * 4, 0}, {kFloatLargest * 4, 0}};
  const std::vector<Complex> farthest{{kLargest, 0}, {-kLargest, 0}};
  const struct {
    std::vector<Complex> positions;
    PositionFormat format;
    bool fits;
  } cases[] = {{far, kFloats, false},
               {far, kRelative, true},
               {far, kFloatBytes, true},
               {far, kIntegers, true},
               {wide, kRelative, false},
               {wide, kFloatBytes, false},
               {wide, kIntegers, true},
               {farthest, kFloat64, true},
               {farthest, kRelative, false},
               {farthest, kIntegers, false},
               {{{nan, 0}}, kFloats, false},
               {{{0, nan}, {1, 1}}, kRelative, false},
               {{{0, nan}, {1, 1}}, kFloatBytes, false},
               {{{0, nan}, {1, 1}}, kIntegers, false}};
  for (const auto& c : cases) {
    v1::Shape shape;
    const Status written = ToWire(c.positions, c.format, &shape);
    SCOPED_TRACE(&c - cases);
    ASSERT_EQ(written.has_value(), c.fits);
    if (c.fits) continue;
    EXPECT_EQ(written.error().kind, FaultKind::kNumerical);
    EXPECT_EQ(shape.ByteSizeLong(), 0u);
  }
}

TEST(Positions, WhatNoServerOfOursAnswersIsRefused) {
  const std::vector<Complex> positions{{1, 2}, {0.1, -4}};
  const auto refused = [&](const PositionFormat& format, auto change) {
    v1::Shape shape = Written(positions, format);
    change(shape);
    const auto read = PositionsFromWire(shape, format);
    return !read && read.error().kind == FaultKind::kInternal;
  };
  const auto halved = [](v1::Shape& shape) { shape.mutable_packed_positions()->pop_back(); };
  EXPECT_TRUE(refused(kFloats, [](v1::Shape& shape) { shape.add_positions(1); }));
  EXPECT_TRUE(refused(kFloats, [](v1::Shape& shape) { shape.add_origin(1); }));
  EXPECT_TRUE(refused(kFloats, [](v1::Shape& shape) { shape.set_packed_positions("12345678"); }));
  EXPECT_TRUE(refused(kFloat64, [](v1::Shape& shape) { shape.mutable_origin()->Resize(2, 0); }));
  EXPECT_TRUE(refused(kFloatBytes, halved));
  EXPECT_TRUE(refused(kFloatBytes, [](v1::Shape& shape) { shape.add_positions(1); }));
  EXPECT_TRUE(refused(kIntegers, halved));
  EXPECT_TRUE(refused(kIntegers, [](v1::Shape& shape) { shape.clear_origin(); }));
  for (const double scale :
       {-1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_TRUE(refused(kIntegers, [&](v1::Shape& shape) { shape.set_scale(scale); })) << scale;
  }
}

TEST(Positions, FormatsAndSubsetsHaveRules) {
  for (const PositionFormat& format : {kFloat64, kFloats, kRelative, kFloatBytes, kIntegers}) {
    v1::DeformOptions options;
    ToWire(format, &options);
    const auto read = FormatFromWire(options);
    ASSERT_TRUE(read);
    EXPECT_EQ(read->float64, format.float64);
    EXPECT_EQ(read->relative, format.relative);
    EXPECT_EQ(read->encoding, format.encoding);
  }
  v1::DeformOptions options;
  options.set_encoding(static_cast<v1::PositionEncoding>(77));
  EXPECT_EQ(FormatFromWire(options).error().field, "options.encoding");
  options.set_encoding(v1::POSITION_ENCODING_FLOAT32);
  EXPECT_TRUE(FormatFromWire(options));
  options.set_float64(true);
  EXPECT_EQ(FormatFromWire(options).error().field, "options.encoding");

  for (const std::uint32_t v : {4u, 0u, 2u}) options.add_vertex_subset(v);
  EXPECT_THAT(*SubsetFromWire(options, 5), ElementsAre(4, 0, 2));
  EXPECT_EQ(SubsetFromWire(options, 4).error().kind, FaultKind::kIndexOutOfRange);
  EXPECT_EQ(SubsetFromWire(options, 4).error().field, "options.vertex_subset[0]");
  EXPECT_EQ(SubsetFromWire(options, 2).error().kind, FaultKind::kArrayLength);
  options.add_vertex_subset(0);
  EXPECT_EQ(SubsetFromWire(options, 5).error().kind, FaultKind::kRepeatedIndex);
  EXPECT_THAT(SubsetFromWire(options, 5).error().elements, ElementsAre(0));
  options.set_boundary_only(true);
  EXPECT_EQ(SubsetFromWire(options, 5).error().kind, FaultKind::kInvalidOption);
}

}  // namespace
}  // namespace arap::convert
