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

#include "tests/bench/cgal_scheme.h"
#include "tests/bench/contenders.h"
#include "tests/bench/deform_section.h"

namespace arap::bench {
namespace {

using Json = nlohmann::ordered_json;

const std::map<std::string, std::size_t> kSizes{{"1k", 1000}, {"10k", 10000}, {"100k", 100000}};
const std::map<std::string, Basis> kBases{{"edge", Basis::kEdge},
                                          {"published", Basis::kEdgeAsPublished},
                                          {"face", Basis::kFace},
                                          {"vertex", Basis::kVertex}};

struct Options {
  std::string json, basis = "edge";
  std::vector<std::string> only, sizes{"1k", "10k", "100k"};
};

// One thread for everybody. Says what it found.
std::string UseOneBlasThread() {
  using SetThreads = void (*)(int);
  if (void* symbol = dlsym(RTLD_DEFAULT, "openblas_set_num_threads")) {
    reinterpret_cast<SetThreads>(symbol)(1);
    return "OpenBLAS, 1 thread";
  }
  return "not OpenBLAS, threads as they come";
}

using MakeScene = Scene (*)(std::size_t);

Json DeformSection(const Options& options, MakeScene make) {
  Json section = Json::object();
  for (const std::string& size : options.sizes) {
    const Scene scene = make(kSizes.at(size));
    section[size] = MeasureDeform(scene, kBases.at(options.basis));
    PrintDeform(scene, section[size]);
    std::fflush(stdout);
  }
  return section;
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
  };
  return sections;
}

int Run(const Options& options) {
  fmt::print("BLAS       {}\n", UseOneBlasThread());
  fmt::print("CGAL       {}\n", CgalScheme::Available()
                                    ? CgalScheme::Version() + ", ORIGINAL_ARAP, sparse LU"
                                    : "not found: its columns are left out");
  fmt::print("basis      {}, uniform weights\n", options.basis);
  Json all = Json::object();
  for (const Section& section : Sections()) {
    const auto& only = options.only;
    if (!only.empty() && std::ranges::find(only, section.only) == only.end()) continue;
    all[section.name] = section.run(options);
  }
  if (options.json.empty()) return 0;
  std::ofstream file(options.json);
  file << all.dump(2) << '\n';
  if (!file.flush()) Die("cannot write " + options.json);
  return 0;
}

}  // namespace
}  // namespace arap::bench

int main(int argc, char** argv) {
  using namespace arap::bench;
  Options options;
  CLI::App app{"Our core beside other ways of doing the same"};
  app.add_option("--json", options.json, "write the figures to this file");
  app.add_option("--only", options.only, "sections to run")
      ->delimiter(',')
      ->check(CLI::IsMember({"deform"}));
  app.add_option("--sizes", options.sizes, "sizes of the meshes")
      ->delimiter(',')
      ->check(CLI::IsMember(kSizes));
  app.add_option("--basis", options.basis, "cells of our energy; the paper's are \"published\"")
      ->check(CLI::IsMember(kBases));
  CLI11_PARSE(app, argc, argv);
  return Run(options);
}
