// arapctl handles: the handle sets of a session.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "client/cli/commands/commands.h"
#include "client/cli/reply.h"
#include "client/cli/report.h"
#include "core/base/try.h"
#include "core/files/text_file.h"
#include "core/files/track_file.h"

namespace arap::cli {
namespace {

struct HandleFlags : NamedOptions {
  std::string mesh;
  std::string track;
  bool hard = false;
  std::vector<std::string> remove;
  std::vector<std::string> points;
  std::vector<std::string> targets;
};

// "X,Y" as two finite numbers.
std::optional<Complex> ParsePoint(std::string_view text) {
  double x = 0, y = 0;
  const char* const end = text.data() + text.size();
  const auto [comma, first] = std::from_chars(text.data(), end, x);
  if (first != std::errc() || comma == end || *comma != ',') return std::nullopt;
  const auto [stop, second] = std::from_chars(comma + 1, end, y);
  if (second != std::errc() || stop != end || !std::isfinite(x) || !std::isfinite(y)) {
    return std::nullopt;
  }
  return Complex(x, y);
}

CLI::Validator IsPoint(bool named) {
  return CLI::Validator(
      [named](std::string& text) {
        const std::size_t equals = named ? text.find('=') : std::string::npos;
        if (named && equals == std::string::npos) return text + " is not NAME=X,Y";
        const std::string point = named ? text.substr(equals + 1) : text;
        return ParsePoint(point) ? std::string() : point + " is not X,Y";
      },
      "");
}

OrderedJson PointJson(Complex point) { return {point.real(), point.imag()}; }

OrderedJson ToJson(const client::HandleSetInfo& set) {
  OrderedJson handles = OrderedJson::array();
  for (const PlacedHandle& placed : set.handles) {
    handles.push_back({{"name", placed.handle.id},
                       {"rest", PointJson(placed.rest)},
                       {"snapped_distance", placed.snapped_distance},
                       {"component", placed.component}});
  }
  return {{"id", set.id},
          {"mesh", set.mesh_id},
          {"handles", std::move(handles)},
          {"rows", set.row_count},
          {"bytes", set.bytes},
          {"revision", set.revision},
          {"resting_components", set.resting_components},
          {"translating_components", set.translating_components}};
}

std::string HandlesText(const client::HandleSetInfo& set) {
  std::vector<std::vector<std::string>> rows{{"HANDLE", "REST", "COMPONENT"}};
  for (const PlacedHandle& placed : set.handles) {
    rows.push_back({Printable(placed.handle.id),
                    fmt::format("{:.6g},{:.6g}", placed.rest.real(), placed.rest.imag()),
                    std::to_string(placed.component)});
  }
  return fmt::format("handles   {}\nmesh      {}\nrevision  {}\nrows      {}\nbytes     {}\n",
                     Printable(set.id), Printable(set.mesh_id), set.revision, set.row_count,
                     set.bytes) +
         Table(rows);
}

Reply ReplyOf(const client::HandleSetInfo& set) {
  PrintWarnings(set.warnings);
  return {ToJson(set), HandlesText(set)};
}

// The handles of a track, whose frames do not matter here.
Result<std::vector<Handle>> ReadHandles(const HandleFlags& flags) {
  TRY(const Track track, ReadTrack(flags.track));
  PrintWarnings(track.warnings);
  return ToHandles(track, flags.hard);
}

Result<Reply> CompileHandles(const HandleFlags& flags) {
  TRY(const std::vector<Handle> handles, ReadHandles(flags));
  TRY(const Connection connection, Connection::Open(flags.server));
  const client::Session session = connection.client().AttachSession(flags.session());
  TRY(const client::Compilation compiled,
      session.CompileHandles(flags.part(), flags.mesh, handles, flags.call()));
  return ReplyOf(compiled.handle_set);
}

Result<Reply> ListHandles(const HandleFlags& flags) {
  TRY(const Connection connection, Connection::Open(flags.server));
  const client::Session session = connection.client().AttachSession(flags.name);
  TRY(const client::SessionInfo info, session.Get(flags.call()));
  OrderedJson list = OrderedJson::array();
  std::vector<std::vector<std::string>> rows{{"SET", "MESH", "HANDLES", "REVISION", "BYTES"}};
  for (const std::string& id : info.handle_set_ids) {
    TRY(const client::HandleSetInfo set, session.GetHandleSet(id, flags.call()));
    list.push_back(ToJson(set));
    rows.push_back({Printable(set.id), Printable(set.mesh_id), std::to_string(set.handles.size()),
                    std::to_string(set.revision), std::to_string(set.bytes)});
  }
  return Reply{{{"handle_sets", std::move(list)}}, Table(rows)};
}

Result<Reply> ShowHandles(const HandleFlags& flags) {
  TRY(const Connection connection, Connection::Open(flags.server));
  const client::Session session = connection.client().AttachSession(flags.session());
  TRY(const client::HandleSetInfo set, session.GetHandleSet(flags.part(), flags.call()));
  return ReplyOf(set);
}

Result<Reply> EditHandles(const HandleFlags& flags) {
  std::vector<Handle> added;
  if (!flags.track.empty()) {
    TRY(added, ReadHandles(flags));
  }
  TRY(const Connection connection, Connection::Open(flags.server));
  const client::Session session = connection.client().AttachSession(flags.session());
  TRY(const client::Compilation edited,
      session.EditHandles(flags.part(), flags.remove, added, flags.call()));
  return ReplyOf(edited.handle_set);
}

Result<Reply> DeleteHandles(const HandleFlags& flags) {
  TRY(const Connection connection, Connection::Open(flags.server));
  const client::Session session = connection.client().AttachSession(flags.session());
  CHECK_OK(session.DeleteHandleSet(flags.part(), flags.call()));
  return Reply{{{"deleted", flags.name}}, fmt::format("deleted {}\n", flags.name)};
}

// Every handle where it rests, but for those that --target moves.
Result<std::vector<HandleTarget>> TargetsOf(const client::HandleSetInfo& set,
                                            const std::vector<std::string>& moved) {
  std::vector<HandleTarget> targets;
  for (const PlacedHandle& placed : set.handles) {
    targets.push_back({placed.handle.id, {placed.rest}});
  }
  for (const std::string& text : moved) {
    const std::size_t equals = text.find('=');
    const auto found = std::find_if(targets.begin(), targets.end(), [&](const HandleTarget& one) {
      return one.handle_id == text.substr(0, equals);
    });
    if (found == targets.end()) {
      return Fail(FaultKind::kUnknownHandle,
                  fmt::format("--target {}: the set has no such handle.", text));
    }
    found->target.position = *ParsePoint(text.substr(equals + 1));  // the command line was checked
  }
  return targets;
}

Result<Reply> PickPoints(const HandleFlags& flags) {
  TRY(const Connection connection, Connection::Open(flags.server));
  const client::Session session = connection.client().AttachSession(flags.session());
  TRY(const client::HandleSetInfo set, session.GetHandleSet(flags.part(), flags.call()));
  TRY(const std::vector<HandleTarget> targets, TargetsOf(set, flags.targets));
  std::vector<Complex> points;
  for (const std::string& text : flags.points) points.push_back(*ParsePoint(text));
  client::ShapeOptions how;
  how.float64 = true;
  TRY(const client::Shape shape, session.Deform(flags.part(), targets, how, points, flags.call()));
  Reply answer{{{"picks", OrderedJson::array()}}, {}};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::optional<client::Pick>& pick = shape.picks[i];
    OrderedJson json{{"point", PointJson(points[i])}, {"hit", pick.has_value()}};
    answer.text += fmt::format("{:.6g},{:.6g}: ", points[i].real(), points[i].imag());
    if (pick) {
      json["rest"] = PointJson(pick->rest);
      json["triangle"] = pick->triangle;
      json["bary"] = pick->barycentric;
      answer.text += fmt::format("rest {:.6g},{:.6g} in triangle {}\n", pick->rest.real(),
                                 pick->rest.imag(), pick->triangle);
    } else {
      answer.text += "nothing there\n";
    }
    answer.json["picks"].push_back(std::move(json));
  }
  return answer;
}

}  // namespace

void AddHandles(CLI::App& app, Run& run) {
  CLI::App* const handles = app.add_subcommand("handles", "Handle sets of a session on a server");
  handles->require_subcommand(1);
  const auto add = [&](const char* name, const char* help, const char* shape,
                       Result<Reply> (*action)(const HandleFlags&)) {
    auto flags = std::make_shared<HandleFlags>();
    CLI::App* const command = handles->add_subcommand(name, help);
    AddNamed(*command, *flags, shape, "which one");
    SetReply(*command, run, flags, action);
    return std::pair(command, flags);
  };
  const char* const kHard = "meet the targets exactly, whatever weight the track gives";
  {
    const auto [command, flags] = add("compile", "Make a handle set of the handles of a track",
                                      "SESSION/SET", &CompileHandles);
    command->add_option("MESH", flags->mesh, "the mesh of the session that they are on")
        ->required();
    command->add_option("TRACK", flags->track, "the handles: TRACK.json; its frames do not count")
        ->required();
    command->add_flag("--hard", flags->hard, kHard);
  }
  add("list", "The handle sets of a session, a line for each", "SESSION", &ListHandles);
  add("show", "The handles of a set and where they rest", "SESSION/SET", &ShowHandles);
  {
    const auto [command, flags] =
        add("edit", "Remove and add handles without factoring again", "SESSION/SET", &EditHandles);
    auto* const what = command->add_option_group("Edit", "what to change, at least one");
    what->add_option("--remove", flags->remove, "the name of a handle; may be given again")
        ->allow_extra_args(false)
        ->option_text("NAME");
    what->add_option("--add", flags->track, "the handles of a track; its frames do not count")
        ->option_text("FILE.json");
    what->require_option(1, 0);
    command->add_flag("--hard", flags->hard, kHard);
  }
  add("delete", "Forget a handle set", "SESSION/SET", &DeleteHandles);
  {
    const auto [command, flags] =
        add("pick", "Say which rest point and triangle lie under points of a shape", "SESSION/SET",
            &PickPoints);
    command->add_option("--pick", flags->points, "a point of the shape; may be given again")
        ->required()
        ->allow_extra_args(false)
        ->check(IsPoint(/*named=*/false))
        ->option_text("X,Y");
    command
        ->add_option("--target", flags->targets,
                     "where a handle is; those that are not told are where they rest")
        ->allow_extra_args(false)
        ->check(IsPoint(/*named=*/true))
        ->option_text("NAME=X,Y");
  }
}

}  // namespace arap::cli
