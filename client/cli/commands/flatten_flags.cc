#include "client/cli/commands/flatten_flags.h"

#include <algorithm>
#include <climits>
#include <cstdint>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "client/cli/commands/commands.h"
#include "client/cli/commands/flatten_inputs.h"
#include "client/cli/reply.h"
#include "core/base/names.h"
#include "core/base/try.h"
#include "core/drawing/page.h"
#include "core/files/text_file.h"

namespace arap::cli {
namespace {

void AddOutputs(CLI::App& command, FlattenFlags& flags) {
  auto* const outputs = command.add_option_group("Output", "what to write, at least one");
  auto* const out = AddOutput(*outputs, "--out", flags.out,
                              "the surface with flat positions as vt; the rest of an OBJ file is "
                              "kept, other formats are written anew",
                              "FILE.obj");
  AddChoice<FlattenFlags::Vt>(
      *outputs, "--vt", flags.vt,
      {{"true", FlattenFlags::Vt::kTrue}, {"unit", FlattenFlags::Vt::kUnit}},
      "the size of the layout in --out: true, in units of the surface; or unit, all pieces scaled "
      "alike into 0 to 1; default true")
      ->needs(out);
  AddOutput(*outputs, "--svg", flags.drawing.svg,
            "the pieces at true size, each triangle coloured by its larger principal strain",
            "FILE.svg");
  AddOutput(*outputs, "--dxf", flags.drawing.dxf,
            "the pieces in millimetres on the layers OUTLINE, SEAM, CUT, GRAIN, NOTCH and LABEL",
            "FILE.dxf");
  AddOutput(*outputs, "--pdf", flags.drawing.pdf,
            "the same as --svg on one page, or the lines on those of --paper", "FILE.pdf");
  auto* const report = AddOutput(*outputs, "--report", flags.report,
                                 "the measures of distortion and what was cut", "FILE.json");
  outputs
      ->add_flag("--sigma", flags.sigma,
                 "list the singular values s1 s2 of every triangle in the report too")
      ->needs(report);
  AddOutput(*outputs, "--compare", flags.compare,
            "the layouts of several methods side by side with their measures; --method, --basis, "
            "--weights, --anchors, --refine and --injective do not change it",
            "FILE.svg");
  AddJson(*outputs, flags.json);
  outputs->require_option(1, 0);
}

void AddDrawing(CLI::App& command, FlattenFlags& flags) {
  DrawingOptions& options = flags.drawing.options;
  auto* const drawing = command.add_option_group("Drawing", "how --svg, --dxf and --pdf draw");
  AddChoice<double>(*drawing, "--unit", options.millimetres_per_unit,
                    {{"mm", 1}, {"cm", 10}, {"m", 1000}, {"in", 25.4}},
                    "what a unit of the surface is; default mm");
  drawing
      ->add_option(
          "--allowance", options.allowance,
          "seam allowance round the pieces, in millimetres; pieces that it brings together "
          "are set apart")
      ->check(Between(1e-9, kMaxAllowance))
      ->option_text("MM");
  AddChoice<Corners>(
      *drawing, "--corners", options.corners,
      {{"mitre", Corners::kMitre}, {"square", Corners::kSquare}, {"round", Corners::kRound}},
      "of the allowance: until its sides meet (at twice its width at most), cut off at its width, "
      "or an arc; default mitre");
  drawing->add_flag("--notches", options.notches,
                    "pair the two sides of every seam by short lines with a number");
  drawing
      ->add_option("--sheet-width", options.sheet_width,
                   "pack the pieces into a roll of this width, in millimetres, which runs along u; "
                   "pieces with a --grain keep their direction")
      ->check(Positive())
      ->option_text("MM");
  drawing
      ->add_option("--paper", options.paper,
                   "pages to print and join, for --pdf and --svg (a file per page): A0 to A5, "
                   "letter, legal, tabloid or WIDTHxHEIGHT in millimetres; lines only")
      ->check(CLI::Validator(
          [](std::string& text) {
            const Result<Paper> paper = ParsePaper(text);
            return paper ? std::string() : paper.error().message;
          },
          ""))
      ->option_text("PAPER");
  drawing
      ->add_option("--overlap", options.overlap,
                   "what pages share with their neighbours, in millimetres; default 10")
      ->check(Between(0, 1000))
      ->option_text("MM");
  drawing
      ->add_option("--margin", options.margin,
                   "what the printer does not reach on each side of a page, in millimetres; "
                   "default 10")
      ->check(Between(0, kMaxPageMargin))
      ->option_text("MM");
  drawing->add_flag("--interior", options.interior,
                    "draw the edges inside too; SVG and PDF without --paper");
  drawing->add_flag("--plain", options.plain,
                    "nothing besides the lines, no names either; SVG and PDF");
}

void AddSurfaceFlags(CLI::App& command, FlattenFlags& flags) {
  CutOptions& cut = flags.query.options.cut;
  auto* const surface = command.add_option_group("Surface", "what is cut, held and repaired");
  surface
      ->add_option("--seams", flags.seams,
                   "edges to cut first: lines of vertices from 1, cut from each to the next; or "
                   "JSON pairs from 0, a report with its cut_edges among them")
      ->option_text("FILE");
  surface
      ->add_option("--pins", flags.pins,
                   "vertices held at places: lines 'vertex u v [weight]', vertices from 1")
      ->option_text("FILE");
  surface
      ->add_option("--rigidity", flags.rigidity,
                   "how rigid every triangle is, above 0 to 1e6, 1 is neutral: a number on a line "
                   "or a JSON array, in the order of the triangles")
      ->option_text("FILE");
  surface
      ->add_option(
          "--grain", flags.grain,
          "keep the direction from one vertex to another at ANGLE degrees from the u axis, "
          "default 0; vertices from 1; may be given again for other pieces")
      ->allow_extra_args(false)
      ->check(CLI::Validator(
          [](std::string& text) {
            const Result<GrainLine> line = ParseGrain(text);
            return line ? std::string() : line.error().message;
          },
          ""))
      ->option_text("FROM,TO[,ANGLE]");
  surface->add_flag(
      "--auto-cut", cut.auto_cut,
      "cut one-sided and closed pieces, handles and several boundaries open to disks");
  surface->add_flag("--split-non-manifold", cut.split_non_manifold,
                    "split edges with more than two triangles and touching vertices");
  surface->add_flag("--tolerate-degenerate", cut.tolerate_degenerate,
                    "leave triangles without area out");
  surface
      ->add_option("--surface-key", flags.query.surface_key,
                   "the server keeps the prepared surface under this name for a while")
      ->option_text("NAME");
}

using Method = MethodFlags::Method;

std::map<std::string, Method> Methods() {
  return {{"arap-edge", Method::kArapEdge},
          {"arap-face", Method::kArapFace},
          {"lscm", Method::kLscm},
          {"first-step", Method::kFirstStep},
          {"abf", Method::kAbf}};
}

void AddMethodFlags(CLI::App& command, MethodFlags& flags) {
  AddChoice(command, "--method", flags.method, Methods(),
            "which layout; default both steps with the basis, arap-face without one");
  AddBasis(command, flags.basis, /*planar=*/false,
           "what moves rigidly, where the method leaves it open");
  AddWeights(command, flags.weights, "of the edges; default cotangent");
  AddChoice<FlattenAnchors>(
      command, "--anchors", flags.anchors,
      {{"center-edge", FlattenAnchors::kCentreEdge},
       {"far-boundary", FlattenAnchors::kFarBoundary},
       {"spectral", FlattenAnchors::kSpectral}},
      "what fixes the first step; default center-edge, spectral for lscm and abf");
  command
      .add_option(
          "--refine", flags.refine,
          "at most so many iterations afterwards; default until converged for arap methods, else 0")
      ->option_text("N");
  command
      .add_option("--refine-stop", flags.refine_stop,
                  "converged: two iterations lower the energy by less than this part; default 3e-5")
      ->check(Between(0, 1))
      ->option_text("X");
  command.add_flag("--injective", flags.injective, "no flipped triangle, or a failure");
}

FlattenOptions PresetOf(Method method) {
  switch (method) {
    case Method::kArap:
    case Method::kArapFace:
      return ArapOptions();
    case Method::kArapEdge:
      return ArapOptions(Basis::kEdge);
    case Method::kLscm:
      return LscmOptions();
    case Method::kFirstStep:
      return FirstStepOptions();
    case Method::kAbf:
      return AbfOptions();
  }
  return ArapOptions();
}

bool Allows(Method method, Basis basis) {
  switch (method) {
    case Method::kArap:
    case Method::kFirstStep:
      return true;
    case Method::kArapEdge:
      return basis == Basis::kEdge || basis == Basis::kEdgeAsPublished;
    case Method::kArapFace:
    case Method::kLscm:
    case Method::kAbf:
      return basis == Basis::kFace;
  }
  return true;
}

auto DoesNotGo(const char* flag, Method method, const char* field) {
  std::string named;
  for (const auto& [name, value] : Methods()) {
    if (value == method) named = name;
  }
  return Fail(Fault(FaultKind::kInvalidOption,
                    fmt::format("This {} does not go with --method {}.", flag, named))
                  .Field(field));
}

// Nothing without a file.
Result<std::string> ReadInput(const char* flag, const std::string& path) {
  if (path.empty()) return std::string();
  Result<std::string> text = ReadTextFile(path);
  if (!text) text.error().message = fmt::format("{} {}", flag, text.error().message);
  return text;
}

}  // namespace

Result<FlattenOptions> MethodFlags::Options() const {
  if (basis && !Allows(method, *basis)) return DoesNotGo("--basis", method, "energy.basis");
  const bool conformal = method == Method::kLscm || method == Method::kAbf;
  if (conformal && weights == Weights::kUniform) {
    return DoesNotGo("--weights", method, "energy.weights");
  }
  FlattenOptions options = PresetOf(method);
  if (basis) options.energy.basis = *basis;
  if (weights) options.energy.weights = *weights;
  if (anchors) options.anchors = *anchors;
  if (refine) options.refine = static_cast<int>(std::min<std::uint32_t>(*refine, INT_MAX));
  if (refine_stop) options.refine_stop = *refine_stop;
  options.injective = injective;
  return options;
}

void AddFlattenFlags(CLI::App& command, FlattenFlags& flags) {
  command
      .add_option("SURFACE", flags.surface,
                  "the surface: an OBJ, OFF, STL, PLY or glTF file, also packed (.gz)")
      ->required();
  AddServerFlags(command, flags.server);
  AddMethodFlags(command, flags.method);
  AddTimeout(command, flags.timeout);
  command
      .add_option("--job", flags.job,
                  "as a job that goes on by itself: asking again with the same name finds it")
      ->check(CLI::Validator(
          [](std::string& text) {
            const std::size_t slash = text.find('/');
            const bool good = slash != std::string::npos &&
                              CheckName(text.substr(0, slash), "job").has_value() &&
                              CheckName(text.substr(slash + 1), "job").has_value();
            return good ? std::string() : text + " is not SESSION/JOB";
          },
          ""))
      ->option_text("SESSION/JOB");
  AddSurfaceFlags(command, flags);
  AddRepairs(command, flags.query.options.cut.repair);
  AddOutputs(command, flags);
  AddDrawing(command, flags);
}

Result<FlattenTexts> ReadTexts(const FlattenFlags& flags) {
  FlattenTexts texts;
  TRY(texts.seams, ReadInput("--seams", flags.seams));
  TRY(texts.pins, ReadInput("--pins", flags.pins));
  TRY(texts.rigidity, ReadInput("--rigidity", flags.rigidity));
  return texts;
}

Result<client::FlattenQuery> ReadQuery(const FlattenFlags& flags, const FlattenTexts& texts,
                                       std::size_t vertex_count, std::size_t triangle_count) {
  client::FlattenQuery query = flags.query;
  FlattenOptions& options = query.options;
  CutOptions cut = std::move(options.cut);
  TRY(options, flags.method.Options());
  options.cut = std::move(cut);
  if (!flags.seams.empty()) {
    TRY(options.cut.seams, ParseSeams(texts.seams, "--seams " + flags.seams, vertex_count));
  }
  if (!flags.pins.empty()) {
    TRY(options.pins, ParsePins(texts.pins, "--pins " + flags.pins, vertex_count));
  }
  if (!flags.rigidity.empty()) {
    TRY(options.energy.rigidity,
        ParseRigidity(texts.rigidity, "--rigidity " + flags.rigidity, triangle_count));
  }
  for (const std::string& text : flags.grain) {
    TRY(const GrainLine line, ParseGrain(text));
    CHECK_OK(CheckGrain(line, vertex_count));
    options.grain_lines.push_back(line);
  }
  return query;
}

std::vector<Origin> OriginsOf(const FlattenFlags& flags, const FlattenTexts& texts,
                              const Counting& mesh) {
  constexpr std::size_t kAll = SIZE_MAX;
  // A file, and of an entry of it the line.
  const auto place = [](const std::string& name, auto of_entry) {
    return [name, of_entry](std::string_view rest) {
      const std::size_t entry = EntryOf(rest, kAll);
      return entry == kAll ? name : of_entry(name, entry);
    };
  };
  const auto seam = [&texts](const std::string& name, std::size_t number) {
    return PlaceOfSeam(texts.seams, name, number / 2);  // two numbers make a seam
  };
  const auto pin = [&texts](const std::string& name, std::size_t number) {
    return PlaceOfPin(texts.pins, name, number);
  };
  const auto rigidity = [&texts](const std::string& name, std::size_t number) {
    return PlaceOfRigidity(texts.rigidity, name, number);
  };
  const auto grain = [&flags](const std::string& name, std::size_t number) {
    return number < flags.grain.size() ? name + " " + flags.grain[number] : name;
  };
  const auto counts = [&mesh](std::uint32_t first) {
    return Counting{first, mesh.face_of, mesh.lines};
  };
  std::vector<Origin> origins{
      {"mesh", "the surface", mesh,
       place(flags.surface, [](const auto& name, auto) { return name; })},
      {"seam_edges", "the seam", counts(FirstVertexIn(texts.seams)),
       place("--seams " + flags.seams, seam)},
      {"pins", "the pin", counts(1), place("--pins " + flags.pins, pin)},
      {"energy.rigidity", "the rigidity", mesh, place("--rigidity " + flags.rigidity, rigidity)},
      {"grain_lines", "the line", counts(1), place("--grain", grain)},
  };
  for (const auto& [field, flag] :
       {std::pair("method", "--method"), std::pair("energy.basis", "--basis"),
        std::pair("energy.weights", "--weights"), std::pair("anchors", "--anchors"),
        std::pair("refine", "--refine"), std::pair("refine_stop", "--refine-stop"),
        std::pair("injective", "--injective"), std::pair("surface_key", "--surface-key"),
        std::pair("repair.tolerance", "--weld"), std::pair("repair.stitch", "--stitch"),
        std::pair("session_id", "--job"), std::pair("job_id", "--job")}) {
    origins.push_back(
        {field, "", mesh, [name = std::string(flag)](std::string_view) { return name; }});
  }
  return origins;
}

}  // namespace arap::cli
