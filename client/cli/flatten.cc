// arapctl flatten: a surface laid flat, true to size.
#include <memory>

#include <fmt/format.h>

#include "client/cli/commands.h"
#include "client/cli/connection.h"
#include "client/cli/flatten_report.h"
#include "client/cli/mesh_file.h"
#include "client/cli/option_names.h"
#include "client/cli/report.h"
#include "client/cli/svg/layout.h"
#include "client/cli/text_file.h"

namespace arap::cli {
namespace {

struct FlattenFlags {
  ServerFlags server;
  std::string surface;
  std::string out;
  std::string svg;
  std::string report;
  client::FlattenOptions options;
};

// A server that answers arrays of another length must not make us read past them.
Status CheckLengths(const client::SurfaceMesh& mesh, const client::FlatSurface& flat,
                    bool singular_values) {
  bool good = flat.corner_uv.size() == mesh.triangles.size();
  good = good && (!singular_values || flat.singular_values.size() == 2 * mesh.triangle_count());
  for (const std::uint32_t corner : flat.corner_uv) good = good && 2 * corner + 1 < flat.uv.size();
  if (good) return {};
  return Fail(FaultKind::kInternal, "the server's answer does not fit the mesh");
}

Status Flatten(const FlattenFlags& flags) {
  const Result<client::SurfaceMesh> mesh = ReadSurfaceMesh(flags.surface);
  if (!mesh) return Fail(mesh.error());
  const Result<Connection> connection = Connection::Open(flags.server);
  if (!connection) return Fail(connection.error());
  client::FlattenOptions options = flags.options;
  options.float64 = true;
  options.singular_values = !flags.svg.empty();
  const Result<client::FlatSurface> flat = connection->client().Flatten(*mesh, options);
  if (!flat) return Fail(flat.error());
  if (Status good = CheckLengths(*mesh, *flat, options.singular_values); !good) return good;
  PrintWarnings(flat->warnings);

  if (Status written = WriteTextFile(flags.out, FormatObj(*mesh, flat->uv, flat->corner_uv));
      !written) {
    return written;
  }
  const std::vector<std::string> summary = Summary(*mesh, *flat);
  for (const std::string& line : summary) fmt::print("{}\n", line);
  if (!flags.svg.empty()) {
    const Layout layout{flat->uv, flat->corner_uv, flat->singular_values, summary};
    if (Status written = WriteTextFile(flags.svg, FormatLayout(layout)); !written) return written;
  }
  if (!flags.report.empty()) return WriteTextFile(flags.report, JsonReport(*mesh, *flat));
  return {};
}

}  // namespace

void AddFlatten(CLI::App& app, Run& run) {
  auto flags = std::make_shared<FlattenFlags>();
  CLI::App* const command =
      app.add_subcommand("flatten", "Lay a surface flat and write its texture coordinates");
  command->add_option("SURFACE", flags->surface, "the surface: an OBJ or OFF file, one disk")
      ->required();
  AddServerFlags(*command, flags->server);
  command->add_option("--out", flags->out, "write the surface with flat positions as vt")
      ->required()
      ->option_text("FILE.obj REQUIRED");
  command
      ->add_option("--svg", flags->svg,
                   "write the layout, each triangle coloured by its larger principal strain")
      ->option_text("FILE.svg");
  command->add_option("--report", flags->report, "write the measures of distortion")
      ->option_text("FILE.json");
  AddEnergyOptions(*command, flags->options.energy, /*planar=*/false);
  command->add_option("--refine", flags->options.refine, "local/global iterations afterwards")
      ->option_text("N");
  command->callback([flags, &run] {
    run = [flags] {
      const Status flattened = Flatten(*flags);
      return flattened ? kOk : Complain(flattened.error());
    };
  });
}

}  // namespace arap::cli
