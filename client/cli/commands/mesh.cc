// arapctl mesh: the figure on an image as a mesh, with the image as its texture.
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "client/cli/commands/commands.h"
#include "client/cli/image.h"
#include "client/cli/reply.h"
#include "client/cli/report.h"
#include "core/base/try.h"
#include "core/files/mesh_file.h"
#include "core/files/obj_writer.h"
#include "core/files/text_file.h"
#include "core/outline/outline.h"
#include "core/outline/quality_mesh.h"

namespace arap::cli {
namespace {

struct MeshFlags {
  std::string image;
  std::string out;
  std::size_t density = 1000;
  double expansion = 0;
  int threshold = 0;  // 0: the default of what it is compared with
  std::string background;
  double tolerance = 1;
  std::size_t specks = 16;
  bool fill_holes = false;
  bool json = false;
};

constexpr std::uint8_t kAlphaThreshold = 128;
constexpr std::uint8_t kColourThreshold = 32;
constexpr double kMaxExpansion = 256;

void Warn(std::string kind, std::size_t count, std::string message,
          std::vector<Warning>& warnings) {
  warnings.push_back({std::move(kind), count, {}, std::move(message)});
}

// RRGGBB, with or without #; nothing when it is something else.
std::optional<Colour> ParseColour(std::string_view text) {
  if (text.starts_with('#')) text.remove_prefix(1);
  std::uint32_t number = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number, 16);
  if (text.size() != 6 || error != std::errc() || stop != text.data() + text.size()) return {};
  return Colour{static_cast<std::uint8_t>(number >> 16U), static_cast<std::uint8_t>(number >> 8U),
                static_cast<std::uint8_t>(number)};
}

Result<Coverage> CoverFigure(const MeshFlags& flags, const Image& image,
                             std::vector<Warning>& warnings) {
  const auto threshold = [&](std::uint8_t standard) {
    return flags.threshold == 0 ? standard : static_cast<std::uint8_t>(flags.threshold);
  };
  if (flags.background.empty()) {
    const std::uint8_t alpha = threshold(kAlphaThreshold);
    if (TransparentPixels(image, alpha) == 0) {
      Warn("opaque_image", 1,
           "The image has no transparent pixel, so all of it is meshed; --background auto takes "
           "the colour of its border for the background.",
           warnings);
    }
    return CoverByAlpha(image, alpha);
  }
  const std::uint8_t difference = threshold(kColourThreshold);
  Colour colour{};
  if (flags.background == "auto") {
    TRY(colour, BorderColour(image, difference));
  } else {
    colour = *ParseColour(flags.background);  // the command line was checked
  }
  return CoverByColour(image, colour, difference);
}

struct Figure {
  std::size_t width = 0, height = 0;  // of the image
  std::vector<Outline> outlines;      // of what is large enough
};

Result<Figure> FindFigure(const MeshFlags& flags, std::vector<Warning>& warnings) {
  TRY(Image image, ReadPng(flags.image));
  Figure figure{image.width, image.height, {}};
  TRY(Coverage coverage, CoverFigure(flags, image, warnings));
  image = {};  // its memory is wanted
  const Dropped dropped =
      DropSpecks(flags.specks, flags.fill_holes ? kEveryHole : flags.specks, coverage);
  if (dropped.pieces > 0 || (dropped.holes > 0 && !flags.fill_holes)) {
    Warn("specks", dropped.pieces + dropped.holes,
         fmt::format("{} and {} of fewer than {} pixels were left out (--specks).",
                     Numbered(dropped.pieces, "piece"), Numbered(dropped.holes, "hole"),
                     flags.specks),
         warnings);
  }
  if (flags.expansion > 0) coverage = Expand(coverage, flags.expansion);
  TRY(figure.outlines, TraceOutlines(coverage));
  if (figure.outlines.empty()) {
    return Fail(FaultKind::kEmptyMesh,
                dropped.pieces == 0
                    ? "Every pixel is background: there is nothing to mesh."
                    : fmt::format("The largest piece has {}: those of fewer than {} are left out "
                                  "(--specks).",
                                  Numbered(dropped.largest_piece, "pixel"), flags.specks));
  }
  return figure;
}

void WarnOfExpansion(const MeshFlags& flags, std::size_t width, std::size_t height,
                     const PlanarMesh& mesh, std::vector<Warning>& warnings) {
  std::size_t outside = 0;
  for (const Complex p : mesh.vertices) {
    outside += p.real() < 0 || p.imag() < 0 || p.real() > static_cast<double>(width) ||
               p.imag() > static_cast<double>(height);
  }
  if (outside == 0) return;
  Warn(
      "outside_image", outside,
      fmt::format("The expansion of {} pixels takes {} beyond the image: their texture "
                  "coordinates are below 0 or above 1.",
                  flags.expansion, outside == 1 ? "1 vertex" : fmt::format("{} vertices", outside)),
      warnings);
}

// The mesh with v from the lower border of the image, as OBJ files have it.
std::string FormatTextured(const PlanarMesh& mesh, std::size_t width, std::size_t height) {
  SurfaceMesh surface;
  surface.triangles = mesh.triangles;
  std::vector<Complex> uv;
  for (const Complex p : mesh.vertices) {
    surface.vertices.push_back({p.real(), p.imag(), 0});
    uv.emplace_back(p.real() / static_cast<double>(width), p.imag() / static_cast<double>(height));
  }
  return FormatObj(surface, uv, surface.triangles);
}

Result<Reply> WriteMesh(const MeshFlags& flags) {
  std::vector<Warning> warnings;
  TRY(const Figure figure, FindFigure(flags, warnings));
  TRY(const std::vector<Outline> outlines, SimplifyOutlines(figure.outlines, flags.tolerance));
  TRY(const QualityMesh result, MeshOutlines(outlines, flags.density));
  const PlanarMesh& mesh = result.mesh;
  WarnOfExpansion(flags, figure.width, figure.height, mesh, warnings);
  constexpr std::size_t kMuchMore = 2;
  if (mesh.vertices.size() > kMuchMore * flags.density) {
    Warn("density", mesh.vertices.size(),
         fmt::format("The outlines need {} vertices, though {} were asked for: --tolerance "
                     "simplifies them more.",
                     mesh.vertices.size(), flags.density),
         warnings);
  }
  PrintWarnings(warnings);
  CHECK_OK(WriteTextFile(flags.out, FormatTextured(mesh, figure.width, figure.height)));
  Reply answer{{{"vertices", mesh.vertices.size()},
                {"triangles", mesh.triangles.size()},
                {"pieces", result.pieces},
                {"holes", result.holes},
                {"smallest_angle", result.smallest_angle}},
               {}};
  answer.text = fmt::format(
      "{} vertices, {} triangles, {}, {}; smallest angle {:.1f} degrees\n"
      "the outline is within {} {} of {}\n",
      mesh.vertices.size(), mesh.triangles.size(), Numbered(result.pieces, "piece"),
      Numbered(result.holes, "hole"), result.smallest_angle, flags.tolerance,
      flags.tolerance == 1 ? "pixel" : "pixels",
      flags.expansion > 0
          ? fmt::format("where the figure ends {} pixels further out", flags.expansion)
          : "the figure's");
  return answer;
}

}  // namespace

void AddMesh(CLI::App& app, Run& run) {
  auto flags = std::make_shared<MeshFlags>();
  CLI::App* const command =
      app.add_subcommand("mesh", "Make a mesh of the figure on an image, textured with it");
  command->add_option("IMAGE", flags->image, "the image, a PNG file")
      ->option_text("FILE.png REQUIRED");
  AddOutput(*command, "--out", flags->out, "write the mesh, in pixels with y up",
            "FILE.obj REQUIRED");
  command->add_option("--density", flags->density, "about how many vertices; default 1000")
      ->check(CLI::Range(std::size_t{3}, kMaxAskedVertices).description(""))
      ->option_text("N");
  command
      ->add_option("--expansion", flags->expansion,
                   "go so many pixels beyond the figure, so that soft edges stay whole; default 0")
      ->check(Between(0, kMaxExpansion))
      ->option_text("PX");
  command
      ->add_option("--threshold", flags->threshold,
                   "the alpha from which a pixel belongs to the figure, 1 to 255, default 128; or, "
                   "with --background, the difference from its colour, default 32")
      ->check(CLI::Range(1, 255).description(""))
      ->option_text("A");
  command
      ->add_option("--background", flags->background,
                   "the figure is what has another colour than this; auto: than the border of the "
                   "image. Without it the figure is what is not transparent")
      ->check(CLI::Validator(
          [](std::string& text) -> std::string {
            if (text == "auto" || ParseColour(text)) return {};
            return text + " is neither auto nor a colour like ffffff";
          },
          ""))
      ->option_text("auto|RRGGBB");
  command
      ->add_option("--tolerance", flags->tolerance,
                   "simplify the outline by at most so many pixels; default 1")
      ->check(Between(0.01, 1000))
      ->option_text("PX");
  command
      ->add_option("--specks", flags->specks,
                   "leave out pieces and holes of fewer pixels; default 16")
      ->check(CLI::Range(std::size_t{0}, kMaxImagePixels).description(""))
      ->option_text("N");
  command->add_flag("--fill-holes", flags->fill_holes, "close all holes");
  AddJson(*command, flags->json);
  AddMeshCommands(*command, run);
  command->require_subcommand(0, 1);
  // Its commands have their own callbacks, and none of its arguments.
  command->callback([command, flags, &run] {
    if (!command->get_subcommands().empty()) return;
    if (flags->image.empty()) throw CLI::RequiredError("IMAGE");
    if (flags->out.empty()) throw CLI::RequiredError("--out");
    run = [flags] { return Finish(OrOutOfMemory([&] { return WriteMesh(*flags); }), flags->json); };
  });
}

}  // namespace arap::cli
