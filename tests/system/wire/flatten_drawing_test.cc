// Drawings over the wire: asked for with a flattening, answered as files, refused by their fields.
// That they are those of arapctl, byte by byte, is tested with the command line.
#include <limits>
#include <string>
#include <utility>

#include <gmock/gmock.h>

#include "arap/client/client.h"
#include "tests/support/surfaces.h"
#include "tests/system/wire/flatten_fixture.h"

namespace arap::wire {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class FlattenDrawingTest : public FlattenTest {};

v1::DrawingOptions Drawn(v1::DrawingFormat format) {
  v1::DrawingOptions options;
  options.set_format(format);
  options.set_millimetres_per_unit(10);
  return options;
}

v1::FlattenRequest Asking(const SurfaceMesh& mesh, const v1::DrawingOptions& options) {
  v1::FlattenRequest request = RequestFor(mesh);
  *request.add_drawings() = options;
  return request;
}

TEST_F(FlattenDrawingTest, EveryDrawingIsAnsweredInItsPlace) {
  v1::FlattenRequest request = Asking(BentStrip(), Drawn(v1::DRAWING_FORMAT_PDF));
  *request.add_drawings() = Drawn(v1::DRAWING_FORMAT_SVG);
  *request.add_drawings() = Drawn(v1::DRAWING_FORMAT_DXF);
  v1::DrawingOptions pages = Drawn(v1::DRAWING_FORMAT_SVG);
  pages.set_paper("100x100");
  *request.add_drawings() = pages;
  v1::NamedPart& part = *request.add_parts();
  part.set_name("strip <1>");
  const v1::FlattenResponse response = Flat(request);
  ASSERT_EQ(response.drawings_size(), 4);
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(response.drawings(i).files_size(), 1) << i;
    EXPECT_EQ(response.drawings(i).files(0).page(), "");
    EXPECT_TRUE(response.drawings(i).warnings().empty());
  }
  EXPECT_TRUE(response.drawings(0).files(0).data().starts_with("%PDF-"));
  EXPECT_THAT(response.drawings(1).files(0).data(), HasSubstr("sheet: 60.000 × 20.000 mm"));
  EXPECT_THAT(response.drawings(1).files(0).data(), HasSubstr(">strip &lt;1&gt;</text>"));
  EXPECT_THAT(response.drawings(2).files(0).data(), HasSubstr("\nstrip <1>\n"));
  ASSERT_EQ(response.drawings(3).files_size(), 2);
  EXPECT_EQ(response.drawings(3).files(0).page(), "cover");
  EXPECT_EQ(response.drawings(3).files(1).page(), "1");
}

TEST_F(FlattenDrawingTest, WhatIsDoubtfulIsTold) {
  v1::DrawingOptions options = Drawn(v1::DRAWING_FORMAT_PDF);
  options.set_millimetres_per_unit(0.1);
  v1::FlattenRequest request = Asking(BentStrip(), options);
  request.add_parts()->set_name("袖");
  const v1::FlattenResponse response = Flat(request);
  ASSERT_EQ(response.drawings(0).warnings_size(), 2);
  EXPECT_EQ(response.drawings(0).warnings(0).kind(), "unlikely_size");
  EXPECT_THAT(response.drawings(0).warnings(0).message(), HasSubstr("millimetres_per_unit says"));
  EXPECT_EQ(response.drawings(0).warnings(1).kind(), "unknown_characters");
}

TEST_F(FlattenDrawingTest, EveryBadOptionIsNamed) {
  using Change = void (*)(v1::DrawingOptions&);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::pair<const char*, Change> cases[] = {
      {"format", [](auto& o) { o.clear_format(); }},
      {"format", [](auto& o) { o.set_format(static_cast<v1::DrawingFormat>(77)); }},
      {"corners", [](auto& o) { o.set_corners(static_cast<v1::AllowanceCorners>(77)); }},
      {"millimetres_per_unit", [](auto& o) { o.set_millimetres_per_unit(0); }},
      {"millimetres_per_unit", [](auto& o) { o.set_millimetres_per_unit(kNan); }},
      {"allowance", [](auto& o) { o.set_allowance(-1); }},
      {"sheet_width", [](auto& o) { o.set_sheet_width(1e10); }},
      {"sheet_width", [](auto& o) { o.set_sheet_width(15); }},  // the strip is 20 mm wide
      {"paper", [](auto& o) { o.set_paper("A4 or so"); }},
      {"paper", [](auto& o) { o.set_paper("A5"), o.set_millimetres_per_unit(1e5); }},
      {"overlap", [](auto& o) { o.set_paper("A4"), o.set_overlap(-1); }},
      {"margin", [](auto& o) { o.set_paper("A4"), o.set_margin(kNan); }},
      {"interior", [](auto& o) { o.set_paper("A4"), o.set_interior(true); }},
      {"paper", [](auto& o) { o.set_format(v1::DRAWING_FORMAT_DXF), o.set_paper("A4"); }},
  };
  for (const auto& [field, change] : cases) {
    v1::FlattenRequest request = Asking(BentStrip(), Drawn(v1::DRAWING_FORMAT_SVG));
    *request.add_drawings() = Drawn(v1::DRAWING_FORMAT_SVG);
    change(*request.mutable_drawings(1));
    const WireError error = Refusal(request, grpc::INVALID_ARGUMENT, "INVALID_OPTION");
    EXPECT_THAT(error.fields, ElementsAre("drawings[1]." + std::string(field))) << error.message;
  }
  v1::FlattenRequest request = RequestFor(BentStrip());
  request.add_parts()->set_first_triangle(12);
  EXPECT_THAT(Refusal(request, grpc::INVALID_ARGUMENT, "INVALID_OPTION").fields,
              ElementsAre("parts[0].first_triangle"));
}

TEST_F(FlattenDrawingTest, TooManyOrTooLargeOnesAreRefused) {
  v1::FlattenRequest request = RequestFor(BentStrip());
  for (std::size_t i = 0; i < kMaxDrawings; ++i) {
    *request.add_drawings() = Drawn(v1::DRAWING_FORMAT_DXF);
  }
  const v1::FlattenResponse whole = Flat(request);
  EXPECT_EQ(whole.drawings_size(), static_cast<int>(kMaxDrawings));
  *request.add_drawings() = Drawn(v1::DRAWING_FORMAT_DXF);
  EXPECT_THAT(Refusal(request, grpc::INVALID_ARGUMENT, "INVALID_OPTION").fields,
              ElementsAre("drawings"));

  // While they are drawn, where it cannot be known before.
  request.mutable_drawings()->RemoveLast();
  request.set_max_response_bytes(whole.ByteSizeLong() / 2);
  EXPECT_EQ(Refusal(request, grpc::RESOURCE_EXHAUSTED, "LIMIT_EXCEEDED").metadata.at("quota"),
            "max_response_bytes");
  // Before the work where it can: this surface is none that can be flattened.
  request = Asking(testing::Sphere(20, 30), Drawn(v1::DRAWING_FORMAT_SVG));
  Refusal(request, grpc::INVALID_ARGUMENT, "NOT_A_DISK");
  request.set_max_response_bytes(20'000);
  Refusal(request, grpc::RESOURCE_EXHAUSTED, "LIMIT_EXCEEDED");
  request.clear_drawings();
  Refusal(request, grpc::INVALID_ARGUMENT, "NOT_A_DISK");
}

TEST_F(FlattenDrawingTest, TheyTakeTheirOwnersMemory) {
  // Enough for the flattening, and not for what pages take.
  options().limits.owner.max_bytes = std::size_t{30} << 20u;
  v1::DrawingOptions pages = Drawn(v1::DRAWING_FORMAT_PDF);
  Flat(Asking(BentStrip(), pages));
  pages.set_paper("A4");
  const WireError error =
      Refusal(Asking(BentStrip(), pages), grpc::RESOURCE_EXHAUSTED, "LIMIT_EXCEEDED");
  EXPECT_EQ(error.metadata.at("quota"), "max_bytes_per_owner");
  EXPECT_EQ(host().engine().derived.bytes(), 0u) << "all is given back";
}

TEST_F(FlattenDrawingTest, TheClientLibraryHasThem) {
  const auto client = client::Client::Connect(host().addresses().front());
  const SurfaceMesh mesh = testing::Together(BentStrip(), BentStrip(), {20, 0, 0});
  client::FlattenQuery query;
  client::DrawingOptions svg, pages;
  svg.millimetres_per_unit = pages.millimetres_per_unit = 100;
  svg.allowance = 10;
  svg.corners = client::Corners::kRound;
  pages.paper = "A4";
  query.drawings = {svg, pages};
  query.parts = {{0, "left"}, {12, "right"}};
  const auto answer = client.Flatten(mesh, query);
  ASSERT_TRUE(answer) << answer.error().message;
  ASSERT_EQ(answer->drawings.size(), 2u);
  EXPECT_THAT(answer->drawings[0].files[0].bytes, HasSubstr("id=\"allowance\""));
  EXPECT_THAT(answer->drawings[0].files[0].bytes, HasSubstr(">right</text>"));
  EXPECT_GT(answer->drawings[1].files.size(), 3u);
  EXPECT_EQ(answer->drawings[1].files[0].page, "cover");

  // As a job they come from the store, and the same.
  const auto session = client.CreateSession();
  ASSERT_TRUE(session);
  ASSERT_TRUE(session->SubmitFlatten("job", mesh, query));
  const auto ended = session->WatchJob("job", {});
  ASSERT_TRUE(ended) << ended.error().message;
  const auto result = session->GetResult("job", mesh, query);
  ASSERT_TRUE(result) << result.error().message;
  ASSERT_EQ(result->drawings.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(result->drawings[i].files, answer->drawings[i].files);
  }
  EXPECT_EQ(client.Flatten(mesh)->drawings.size(), 0u);
}

}  // namespace
}  // namespace arap::wire
