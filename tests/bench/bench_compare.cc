// Our core beside other ways of doing the same, in one run: medians of interleaved repetitions, one
// thread. script/bench runs it.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <dlfcn.h>
#include <fmt/format.h>

#include "tests/bench/bumpy_cap.h"
#include "tests/bench/cgal_scheme.h"
#include "tests/bench/compare_runs.h"
#include "tests/bench/contenders.h"
#include "tests/bench/deform_section.h"
#include "tests/bench/estimates_section.h"
#include "tests/bench/flatten_section.h"
#include "tests/bench/layouts_section.h"
#include "tests/bench/surfaces_table.h"
#include "tests/support/hard_surfaces.h"

namespace arap::bench {
namespace {

using Json = nlohmann::ordered_json;

const std::map<std::string, std::size_t> kSizes{
    {"1k", 1000}, {"10k", 10000}, {"100k", 100000}, {"1m", 1000000}};
const std::map<std::string, Basis> kBases{{"edge", Basis::kEdge},
                                          {"published", Basis::kEdgeAsPublished},
                                          {"face", Basis::kFace},
                                          {"vertex", Basis::kVertex}};

struct Options {
  std::string json, compare, basis = "edge", surfaces;
  std::vector<std::string> only, sizes;  // empty: all that a section has
  double budget = 300;
};

// One thread for everybody: processor time is that of the thread that asks. CHOLMOD has loops in
// OpenMP besides those of the BLAS. Says what it found.
std::string UseOneThread() {
  using SetThreads = void (*)(int);
  if (void* symbol = dlsym(RTLD_DEFAULT, "omp_set_max_active_levels")) {
    reinterpret_cast<SetThreads>(symbol)(0);
  }
  if (void* symbol = dlsym(RTLD_DEFAULT, "openblas_set_num_threads")) {
    reinterpret_cast<SetThreads>(symbol)(1);
    return "OpenBLAS, 1 thread";
  }
  return "not OpenBLAS, threads as they come";
}

using MakeScene = Scene (*)(std::size_t);

// Of those that a section has, what was asked for.
std::vector<std::string> SizesOf(const Options& options, std::vector<std::string> sizes) {
  std::erase_if(sizes, [&](const std::string& size) {
    return !options.sizes.empty() && std::ranges::find(options.sizes, size) == options.sizes.end();
  });
  return sizes;
}

Json DeformSection(const Options& options, MakeScene make) {
  Json section = Json::object();
  for (const std::string& size : SizesOf(options, {"1k", "10k", "100k"})) {
    const Scene scene = make(kSizes.at(size));
    section[size] = MeasureDeform(scene, kBases.at(options.basis));
    PrintDeform(scene, section[size]);
    std::fflush(stdout);
  }
  return section;
}

Json FlattenSection(const Options& options) {
  Json section = Json::object();
  for (const std::string& size : SizesOf(options, {"10k", "100k", "1m"})) {
    section[size] = MeasureFlatten(BumpyCap(kSizes.at(size)), options.budget);
    PrintFlatten(section[size], options.budget);
    std::fflush(stdout);
  }
  return section;
}

// The same surfaces whatever sizes were asked for.
Json LayoutsSection(const Options&) {
  Json section = Json::object();
  PrintLayoutsHead();
  for (const auto& [name, mesh] : arap::testing::HardSurfaces()) {
    section[name] = MeasureLayouts(mesh);
    PrintLayouts(name, section[name]);
    std::fflush(stdout);
  }
  return section;
}

// The grid of sizes, or a million alone.
Json EstimatesSection(const Options& options) {
  return MeasureEstimates(options.sizes == std::vector<std::string>{"1m"});
}

struct Section {
  std::string only;  // the name that --only takes
  std::string name;  // in the JSON
  std::function<Json(const Options&)> run;
};

const std::vector<Section>& Sections() {
  static const std::vector<Section> sections{
      {"deform", "deform", [](const Options& o) { return DeformSection(o, GridScene); }},
      {"deform", "deform_character",
       [](const Options& o) { return DeformSection(o, CharacterScene); }},
      {"flatten", "flatten", FlattenSection},
      {"layouts", "layouts", LayoutsSection},
      {"estimates", "estimates", EstimatesSection},
  };
  return sections;
}

int Run(const Options& options) {
  fmt::print("BLAS       {}\n", UseOneThread());
  fmt::print("CGAL       {}\n",
             CgalScheme::Available()
                 ? CgalScheme::Version() + ", defaults: sparse LU, LSCM simplicial LDLᵗ"
                 : "not found: its columns are left out");
  if (!options.surfaces.empty()) {
    PrintSurfacesTable(options.surfaces);
    return 0;
  }
  fmt::print("basis      {}, uniform weights (deform)\n", options.basis);
  Json all = Json::object();
  for (const Section& section : Sections()) {
    const auto& only = options.only;
    if (!only.empty() && std::ranges::find(only, section.only) == only.end()) continue;
    all[section.name] = section.run(options);
  }
  if (!options.json.empty()) {
    std::ofstream file(options.json);
    file << all.dump(2) << '\n';
    if (!file.flush()) Die("cannot write " + options.json);
  }
  if (options.compare.empty()) return 0;
  const Json before = Json::parse(std::ifstream(options.compare), nullptr, false);
  if (!before.is_object()) Die(options.compare + " is not what --json has written");
  const Comparison comparison = CompareRuns(before, all);
  PrintComparison(comparison);
  return comparison.regressed() ? 1 : 0;
}

}  // namespace
}  // namespace arap::bench

int main(int argc, char** argv) {
  using namespace arap::bench;
  Options options;
  CLI::App app{"Our core beside other ways of doing the same"};
  app.add_option("--json", options.json, "write the figures to this file");
  app.add_option(
         "--compare", options.compare,
         "show what has changed since the run that wrote this file; 1 is the exit code when "
         "something of ours has become slower or larger")
      ->check(CLI::ExistingFile);
  app.add_option("--only", options.only, "sections to run")
      ->delimiter(',')
      ->check(CLI::IsMember({"deform", "flatten", "layouts", "estimates"}));
  app.add_option("--sizes", options.sizes, "vertices to deform, triangles to flatten")
      ->delimiter(',')
      ->check(CLI::IsMember(kSizes));
  app.add_option("--basis", options.basis, "cells of our energy; the paper's are \"published\"")
      ->check(CLI::IsMember(kBases));
  app.add_option("--budget", options.budget, "seconds that one flattening may take")
      ->check(CLI::PositiveNumber);
  app.add_option("--surfaces", options.surfaces,
                 "only flatten every OBJ file of this directory in all of our ways")
      ->check(CLI::ExistingDirectory);
  CLI11_PARSE(app, argc, argv);
  return Run(options);
}
