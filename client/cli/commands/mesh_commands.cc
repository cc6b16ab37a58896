// arapctl mesh register, list, show and delete: the meshes of a session.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "client/cli/commands/commands.h"
#include "client/cli/commands/own_words.h"
#include "client/cli/reply.h"
#include "client/cli/report.h"
#include "core/base/try.h"
#include "core/files/mesh_file.h"
#include "core/files/plane_fit.h"

namespace arap::cli {
namespace {

struct RegisterFlags : NamedOptions {
  std::string file;
  EnergyOptions energy;
  RepairOptions repairs;
};

OrderedJson ToJson(const client::MeshInfo& mesh) {
  const RegistrationReport& report = mesh.report;
  return {{"id", mesh.id},
          {"content_hash", mesh.content_hash},
          {"vertices", report.vertices},
          {"triangles", report.triangles},
          {"edges", report.edges},
          {"components", report.components},
          {"boundary_loops", report.boundary_loops},
          {"area", report.area},
          {"diagonal", report.diagonal},
          {"bytes", report.bytes}};
}

std::string MeshText(const client::MeshInfo& mesh) {
  const RegistrationReport& report = mesh.report;
  return fmt::format(
      "mesh        {}\nhash        {}\nvertices    {}\ntriangles   {}\ncomponents  {}\n"
      "boundaries  {}\narea        {:.6g}\ndiagonal    {:.6g}\nbytes       {}\n",
      Printable(mesh.id), Printable(mesh.content_hash), report.vertices, report.triangles,
      report.components, report.boundary_loops, report.area, report.diagonal, report.bytes);
}

Result<Reply> RegisterFile(const RegisterFlags& flags) {
  TRY(SurfaceFile file, ReadSurfaceFile(flags.file));
  PrintWarnings(file.warnings);
  const Counting counting = CountingOf(file);
  const std::vector<Origin> origins{
      {"mesh", "", counting, [&flags](std::string_view) { return flags.file; }}};
  TRY(const PlaneFit fit, InOwnWords(FitPlane(std::move(file.mesh)), origins));
  PrintWarnings(fit.notes);
  TRY(const Connection connection, Connection::Open(flags.server));
  const client::Session session = connection.client().AttachSession(flags.session());
  TRY(const client::Registration registered,
      InOwnWords(
          session.RegisterMesh(fit.mesh, flags.energy, flags.part(), flags.call(), flags.repairs),
          origins));
  PrintWarnings(InOwnWords(registered.mesh.report.warnings, counting));
  OrderedJson json = ToJson(registered.mesh);
  json["shared"] = registered.shared;
  json["solve_micros"] = registered.solve_micros;
  return Reply{std::move(json), MeshText(registered.mesh)};
}

Result<Reply> ListMeshes(const NamedOptions& flags) {
  TRY(const Connection connection, Connection::Open(flags.server));
  const client::Session session = connection.client().AttachSession(flags.name);
  TRY(const client::SessionInfo info, session.Get(flags.call()));
  OrderedJson list = OrderedJson::array();
  std::vector<std::vector<std::string>> rows{{"MESH", "VERTICES", "TRIANGLES", "BYTES"}};
  for (const std::string& id : info.mesh_ids) {
    TRY(const client::MeshInfo mesh, session.GetMesh(id, flags.call()));
    list.push_back(ToJson(mesh));
    rows.push_back({Printable(mesh.id), std::to_string(mesh.report.vertices),
                    std::to_string(mesh.report.triangles), std::to_string(mesh.report.bytes)});
  }
  return Reply{{{"meshes", std::move(list)}}, Table(rows)};
}

Result<Reply> ShowMesh(const NamedOptions& flags) {
  TRY(const Connection connection, Connection::Open(flags.server));
  const client::Session session = connection.client().AttachSession(flags.session());
  TRY(const client::MeshInfo mesh, session.GetMesh(flags.part(), flags.call()));
  PrintWarnings(mesh.report.warnings);
  return Reply{ToJson(mesh), MeshText(mesh)};
}

Result<Reply> DeleteMesh(const NamedOptions& flags) {
  TRY(const Connection connection, Connection::Open(flags.server));
  const client::Session session = connection.client().AttachSession(flags.session());
  CHECK_OK(session.DeleteMesh(flags.part(), flags.call()));
  return Reply{{{"deleted", flags.name}}, fmt::format("deleted {}\n", flags.name)};
}

}  // namespace

void AddMeshCommands(CLI::App& mesh, Run& run) {
  {
    auto flags = std::make_shared<RegisterFlags>();
    CLI::App* const command =
        mesh.add_subcommand("register", "Register a mesh with a session on a server");
    AddNamed(*command, *flags, "SESSION/[MESH]",
             "the session, and what the mesh is called; default a name made of its content");
    command->add_option("FILE", flags->file, "the mesh: a file, in any plane")->required();
    AddRepairs(*command, flags->repairs);
    AddBasis(*command, flags->energy.basis, /*planar=*/true, "what moves rigidly; default edge");
    AddWeights(*command, flags->energy.weights, "of the edges; default uniform");
    SetReply(*command, run, flags, &RegisterFile);
  }
  const auto add = [&](const char* name, const char* help, const char* shape,
                       Result<Reply> (*action)(const NamedOptions&)) {
    auto flags = std::make_shared<NamedOptions>();
    CLI::App* const command = mesh.add_subcommand(name, help);
    AddNamed(*command, *flags, shape, "which one");
    SetReply(*command, run, flags, action);
  };
  add("list", "The meshes of a session on a server, a line for each", "SESSION", &ListMeshes);
  add("show", "A mesh of a session: counts, area, memory", "SESSION/MESH", &ShowMesh);
  add("delete", "Forget a mesh of a session and the handle sets on it", "SESSION/MESH",
      &DeleteMesh);
}

}  // namespace arap::cli
