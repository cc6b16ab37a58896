// arapctl plan: how many servers so many puppets want, and what would be too little first.
#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "client/cli/commands/commands.h"
#include "client/cli/plan/capacity.h"
#include "client/cli/plan/queueing.h"
#include "client/cli/reply.h"

namespace arap::cli {
namespace {

struct PlanFlags {
  Puppets puppets;
  Machine machine;
  double replicas = 0;       // as many as are wanted
  double update_micros = 0;  // by what was measured here
  double memory_gb = 32, network_gbit = 10, use_percent = 70;
  bool json = false;
};

// "1.9 GB", "734 µs": three digits, by thousands.
std::string Scaled(double value, std::string_view unit) {
  constexpr std::array<const char*, 8> kPrefixes{"µ", "m", "", "k", "M", "G", "T", "P"};
  std::size_t prefix = 2;
  if (unit == "s") {
    for (; value > 0 && value < 0.9995 && prefix > 0; --prefix) value *= 1000;
  }
  while (value >= 999.5 && prefix + 1 < kPrefixes.size()) {
    value /= 1000;
    ++prefix;
  }
  const int digits = value >= 99.95 ? 0 : (value >= 9.995 ? 1 : 2);
  const std::string name = std::string(kPrefixes[prefix]) + std::string(unit);
  return fmt::format("{:.{}f}{}{}", value, digits, name.empty() ? "" : " ", name);
}

std::string Percent(double part) { return fmt::format("{:.0f} %", 100 * part); }

// Updates of the streams of one of the servers, which share them evenly.
QueueTimes TimesOf(const PlanFlags& flags, const Plan& plan) {
  QueueInput input;
  input.rate = plan.updates / plan.servers;
  input.streams = static_cast<std::size_t>(std::ceil(flags.puppets.count / plan.servers));
  // Whatever an update costs the server is a turn on one of its cores.
  input.workers = static_cast<std::size_t>(flags.machine.cores);
  input.service = plan.update.core_seconds;
  input.variation = kServiceVariation;
  return SimulateQueue(input);
}

OrderedJson JsonOf(const PlanFlags& flags, const Plan& plan, const QueueTimes& times) {
  const Puppets& puppets = flags.puppets;
  // JSON knows no infinity.
  const auto number = [](double value) {
    return std::isfinite(value) ? OrderedJson(value) : OrderedJson(nullptr);
  };
  return {
      {"puppets", puppets.count},
      {"vertices", puppets.vertices},
      {"fps", puppets.fps},
      {"handles", puppets.handles},
      {"meshes", puppets.meshes},
      {"server",
       {{"cores", flags.machine.cores},
        {"memory_bytes", flags.machine.memory},
        {"network_bytes_per_second", flags.machine.network},
        {"target", flags.machine.target}}},
      {"update",
       {{"core_micros", plan.update.core_seconds * 1e6},
        {"bytes_out", plan.update.bytes_out},
        {"bytes_in", plan.update.bytes_in}}},
      {"memory",
       {{"mesh_bytes", plan.memory.mesh},
        {"session_bytes", plan.memory.session},
        {"record_bytes", plan.memory.record}}},
      {"updates_per_second", plan.updates},
      {"updates_per_core", plan.updates_per_core},
      {"bytes_out_per_second", plan.bytes_out},
      {"store_bytes", plan.store_bytes},
      {"store_writes_per_second", plan.store_writes},
      {"servers",
       {{"for_cores", plan.for_cores},
        {"for_memory", number(plan.for_memory)},
        {"for_network", plan.for_network},
        {"wanted", number(plan.servers)}}},
      {"bound", NameOf(plan.bound)},
      {"next_bound", NameOf(plan.next)},
      {"use",
       {{"cores", plan.core_use},
        {"memory", number(plan.memory_use)},
        {"network", plan.network_use}}},
      {"stable", times.stable},
      {"time_micros",
       {{"mean", times.mean * 1e6},
        {"p50", times.p50 * 1e6},
        {"p90", times.p90 * 1e6},
        {"p99", times.p99 * 1e6}}},
  };
}

std::string TextOf(const PlanFlags& flags, const Plan& plan, const QueueTimes& times) {
  const Puppets& puppets = flags.puppets;
  std::string text = fmt::format(
      "{:.0f} puppets of {:.0f} vertices and {:.0f} handles, {:g} updates a second each, {:.0f} "
      "{}\n\n",
      puppets.count, puppets.vertices, puppets.handles, puppets.fps, puppets.meshes,
      puppets.meshes == 1 ? "mesh" : "meshes");
  text += Table({{"one", "takes", ""},
                 {"mesh", Scaled(plan.memory.mesh, "B"), "once on each server"},
                 {"puppet", Scaled(plan.memory.session, "B"), "on its server"},
                 {"", Scaled(plan.memory.record, "B"), "in the store of sessions"},
                 {"update", Scaled(plan.update.core_seconds, "s"), "of a core"},
                 {"", Scaled(plan.update.bytes_out, "B"), "to the client"}});
  text += "\n";
  text += Table({{"all", "want", "servers", "of each is used"},
                 {"cores",
                  fmt::format("{} updates/s, {} a core", Scaled(plan.updates, ""),
                              Scaled(plan.updates_per_core, "")),
                  fmt::format("{:.1f}", plan.for_cores), Percent(plan.core_use)},
                 {"memory", Scaled(puppets.count * plan.memory.session, "B"),
                  fmt::format("{:.1f}", plan.for_memory), Percent(plan.memory_use)},
                 {"network", Scaled(8 * plan.bytes_out, "bit/s"),
                  fmt::format("{:.1f}", plan.for_network), Percent(plan.network_use)},
                 {"store",
                  fmt::format("{}, {} writes/s", Scaled(plan.store_bytes, "B"),
                              Scaled(plan.store_writes, "")),
                  "", ""}});
  auto out = std::back_inserter(text);
  if (!std::isfinite(plan.servers)) {
    fmt::format_to(out,
                   "\nThe meshes alone do not fit into the memory of a server: no number of "
                   "them is enough.\n");
    return text;
  }
  fmt::format_to(
      out, "\n{:.0f} {} of {:.0f} cores, {} and {}{}. What is too little first: {}; then {}.\n",
      plan.servers, plan.servers == 1 ? "server" : "servers", flags.machine.cores,
      Scaled(flags.machine.memory, "B"), Scaled(8 * flags.machine.network, "bit/s"),
      flags.replicas > 0 ? "" : fmt::format(", cores used to {}", Percent(flags.machine.target)),
      NameOf(plan.bound), NameOf(plan.next));
  if (!times.stable) {
    fmt::format_to(out,
                   "More comes than they can do: with --delivery latest updates are replaced, "
                   "with every they wait.\n");
    return text;
  }
  fmt::format_to(out,
                 "An update is then in the server for {} in the middle, {} at p99 (simulated).\n",
                 Scaled(times.p50, "s"), Scaled(times.p99, "s"));
  return text;
}

Result<Reply> MakeReply(const PlanFlags& given) {
  PlanFlags flags = given;
  flags.machine.memory = flags.memory_gb * 1e9;
  flags.machine.network = flags.network_gbit * 1e9 / 8;
  flags.machine.target = flags.use_percent / 100;
  flags.machine.update_seconds = flags.update_micros / 1e6;
  const Plan plan = MakePlan(flags.puppets, flags.machine, flags.replicas);
  const QueueTimes times = std::isfinite(plan.servers) ? TimesOf(flags, plan) : QueueTimes();
  return Reply{JsonOf(flags, plan, times), TextOf(flags, plan, times)};
}

}  // namespace

void AddPlan(CLI::App& app, Run& run) {
  const auto flags = std::make_shared<PlanFlags>();
  CLI::App* const command = app.add_subcommand(
      "plan", "How many servers so many puppets want, by what was measured (docs/operations.md)");
  const auto number = [command](const char* name, double& value, double low, double high,
                                const char* text, const std::string& help) {
    return command->add_option(name, value, help)->check(Between(low, high))->option_text(text);
  };
  number("--puppets", flags->puppets.count, 1, 1e9, "N", "puppets that are open at a time")
      ->required();
  number("--vertices", flags->puppets.vertices, 3, 1e6, "V", "vertices of each")->required();
  number("--fps", flags->puppets.fps, 0.001, 1'000, "F", "updates a second of each")->required();
  number("--handles", flags->puppets.handles, 1, 1'000, "H", "handles of each; default 8");
  number(
      "--meshes", flags->puppets.meshes, 1, 1e9, "N",
      "different meshes; default 1. Each server holds those of its puppets, all of them at worst");
  number("--replicas", flags->replicas, 1, 1e6, "R",
         "servers that are there; default as many as are wanted");
  number("--cores", flags->machine.cores, 1, 1'024, "N", "cores of a server; default 8");
  number("--memory", flags->memory_gb, 0.1, 1e5, "GB", "its memory; default 32");
  number("--network", flags->network_gbit, 0.001, 1e4, "GBIT/S", "what it can send; default 10");
  number(
      "--update-micros", flags->update_micros, 0.1, 1e9, "MICROS",
      "processor time of an update where they are to run, as tests/bench/replicas.py measures it; "
      "default by the formula of docs/operations.md");
  number("--use", flags->use_percent, 1, 99, "PERCENT",
         "how busy its cores may be, so that there is room for bursts; default 70");
  SetReply(*command, run, flags, &MakeReply);
}

}  // namespace arap::cli
