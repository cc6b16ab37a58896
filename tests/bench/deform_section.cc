#include "tests/bench/deform_section.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "arap/core/deformer.h"
#include "core/deform/registered_parts.h"
#include "core/sparse/factor.h"
#include "tests/bench/cgal_scheme.h"
#include "tests/bench/contenders.h"
#include "tests/bench/samples.h"

namespace arap::bench {
namespace {

using Json = nlohmann::ordered_json;

// What the JSON holds: tenths of a microsecond.
double Median(const Samples& samples) { return std::round(samples.Median() * 10) / 10; }

// A disagreement above rounding, seen through a penalty of 1e6, is an error of somebody.
constexpr double kPaperTolerance = 1e-5;

double CheckAgreement(const Scene& scene) {
  const double distance = PaperDisagreement(scene);
  if (!(distance < kPaperTolerance)) {
    Die(fmt::format("{} of {} vertices: the paper's scheme and ours differ by {:.2g} diagonals",
                    scene.name, scene.mesh.vertices.size(), distance));
  }
  return distance;
}

// CGAL minimises another energy; at least its handles have to be where they were sent.
void CheckHandles(const Scene& scene, CgalScheme& cgal) {
  const auto vertices = HandleVertices(scene);
  const auto& pose = scene.poses.back();
  cgal.Iterate(pose);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (!(std::abs(cgal.Position(vertices[i]) - pose[i]) < 1e-9 * std::abs(pose[i]))) {
      Die(fmt::format("CGAL left handle {} of {} behind", i, scene.name));
    }
  }
}

// Everything that happens once per mesh or handle set. Heavy: seconds for 100k vertices.
void MeasureSetups(const Scene& scene, Basis basis, Json& figures) {
  Samples registers, compiles, adds, removes, paper_registers, paper_compiles, cgal_registers,
      preprocesses;
  const auto paper_handles = PaperHandles(scene);
  const auto vertices = HandleVertices(scene);
  const std::array remove{scene.handles[3].id};
  const int rounds = scene.mesh.vertices.size() > 30000 ? 3 : 9;
  Repeat(rounds, 1, 51, [&] {
    const auto mesh = registers.Time([&] { return Register(scene, basis); });
    auto paper = paper_registers.Time([&] { return std::make_unique<PaperScheme>(scene.mesh); });
    const auto cgal = cgal_registers.Time([&] { return CgalScheme::Make(scene.mesh); });

    const auto set =
        compiles.Time([&] { return Must(CompiledHandles::Compile(mesh, scene.handles)); });
    paper->Compile(paper_handles);  // allocates the factor; every later one is like the next
    paper_compiles.Time([&] { paper->Compile(paper_handles); });
    if (cgal) {
      cgal->SetHandles(vertices);
      preprocesses.Time([&] { cgal->Preprocess(); });
    }
    adds.Time([&] { return Must(set->Edit({}, {scene.extra})); });
    removes.Time([&] { return Must(set->Edit(remove, {})); });

    figures["mesh_bytes"] = mesh->report().bytes;
    figures["handles_bytes"] = set->bytes();
    figures["paper_bytes"] = paper->bytes();
  });
  figures["register_us"] = Median(registers);
  figures["compile8_us"] = Median(compiles);
  figures["add1_us"] = Median(adds);
  figures["remove1_us"] = Median(removes);
  figures["paper_register_us"] = Median(paper_registers);
  figures["paper_compile_us"] = Median(paper_compiles);
  if (CgalScheme::Available()) {
    figures["cgal_register_us"] = Median(cgal_registers);
    figures["cgal_preprocess_us"] = Median(preprocesses);
  }
}

// Every number once, and nothing kept but their sum.
std::uint64_t ReadOnce(const std::vector<std::uint64_t>& numbers) {
  std::uint64_t sum = 0;
  for (const std::uint64_t number : numbers) sum += number;
  return sum;
}

// What happens once per frame: bursts of frames, as in a stream, the first of each untimed.
void MeasureFrames(const Scene& scene, Basis basis, Json& figures) {
  constexpr std::size_t kBurst = 4;
  Samples updates, refines, paper_updates, iterations, floors;
  Deformer deformer(Must(CompiledHandles::Compile(Register(scene, basis), scene.handles)));
  PaperScheme paper(scene.mesh);
  paper.Compile(PaperHandles(scene));
  const auto cgal = CgalScheme::Make(scene.mesh);
  if (cgal) {
    cgal->SetHandles(HandleVertices(scene));
    cgal->Preprocess();
    CheckHandles(scene, *cgal);
  }
  const auto targets = TargetsOf(scene);
  // What no update can be faster than: its back-substitution reads the factor of step 2 forwards and backwards.
  const std::vector<std::uint64_t> factor(
      deformer.handles()->mesh()->parts().rigid->bytes() / sizeof(std::uint64_t), 1);
  std::uint64_t read = 0;
  std::size_t frame = 0;
  // frame_of(pose) is one frame of one contender.
  const auto burst = [&](Samples& samples, auto frame_of) {
    for (std::size_t i = 0; i < kBurst; ++i) {
      const std::size_t pose = (frame + i) % targets.size();
      if (i == 0) {
        frame_of(pose);
      } else {
        samples.Time([&] { frame_of(pose); });
      }
    }
  };
  Repeat(9, 2, 301, [&] {
    burst(updates, [&](std::size_t pose) { Must(deformer.Update(targets[pose])); });
    burst(paper_updates, [&](std::size_t pose) { paper.Update(scene.poses[pose]); });
    burst(floors, [&](std::size_t) {
      for (int pass = 0; pass < 2; ++pass) read += ReadOnce(factor);
    });
    if (cgal) burst(iterations, [&](std::size_t pose) { cgal->Iterate(scene.poses[pose]); });
    burst(refines, [&](std::size_t pose) {
      Must(deformer.Update(targets[pose], {DeformMode::kRigid, 1}));
    });
    frame += kBurst;
  });
  if (read == 0) Die("the factor was not read");
  figures["floor_us"] = Median(floors);
  figures["update_us"] = Median(updates);
  figures["update_over_floor"] = std::round(updates.Median() / floors.Median() * 100) / 100;
  figures["refine1_us"] = Median(refines);
  figures["paper_update_us"] = Median(paper_updates);
  if (cgal) figures["cgal_iteration_us"] = Median(iterations);
}

// Three digits; milliseconds.
std::string Milliseconds(const Json& figures, const char* key) {
  if (!figures.contains(key)) return "";
  const double ms = figures[key].get<double>() / 1000;
  const int digits = ms < 1 ? 3 : ms < 10 ? 2 : ms < 100 ? 1 : 0;
  return fmt::format("{:.{}f}", ms, digits);
}

std::string Ratio(const Json& figures, const char* theirs, const char* ours) {
  if (!figures.contains(theirs)) return "";
  const double ratio = figures[theirs].get<double>() / figures[ours].get<double>();
  return fmt::format("{:.{}f}", ratio, ratio < 100 ? 1 : 0);
}

}  // namespace

Json MeasureDeform(const Scene& scene, Basis basis) {
  const double distance = CheckAgreement(scene);
  Json figures;
  figures["vertices"] = scene.mesh.vertices.size();
  figures["triangles"] = scene.mesh.triangles.size();
  figures["paper_distance"] = distance;
  MeasureSetups(scene, basis, figures);
  MeasureFrames(scene, basis, figures);
  return figures;
}

void PrintDeform(const Scene& scene, const Json& figures) {
  struct Row {
    const char *what, *ours, *paper, *cgal;
  };
  constexpr std::array kRows{
      Row{"register", "register_us", "paper_register_us", "cgal_register_us"},
      Row{"compile 8 handles", "compile8_us", "paper_compile_us", "cgal_preprocess_us"},
      Row{"add one handle", "add1_us", "paper_compile_us", "cgal_preprocess_us"},
      Row{"remove one handle", "remove1_us", "paper_compile_us", "cgal_preprocess_us"},
      Row{"update", "update_us", "paper_update_us", "cgal_iteration_us"},
      Row{"update, refine 1", "refine1_us", "", ""},
  };
  const bool cgal = CgalScheme::Available();
  fmt::print("\n{}, {} vertices, {} triangles, {} handles; ms\n", scene.name,
             scene.mesh.vertices.size(), scene.mesh.triangles.size(), scene.handles.size());
  fmt::print("{:20}{:>10}{:>10}{:>12}", "", "ours", "paper", "paper/ours");
  if (cgal) fmt::print("{:>10}{:>12}", "CGAL", "CGAL/ours");
  fmt::print("\n");
  for (const Row& row : kRows) {
    fmt::print("{:20}{:>10}{:>10}{:>12}", row.what, Milliseconds(figures, row.ours),
               Milliseconds(figures, row.paper), Ratio(figures, row.paper, row.ours));
    if (cgal) {
      fmt::print("{:>10}{:>12}", Milliseconds(figures, row.cgal),
                 Ratio(figures, row.cgal, row.ours));
    }
    fmt::print("\n");
  }
  const auto megabytes = [&](const char* key) { return figures[key].get<double>() / 1e6; };
  fmt::print("same energy, largest distance from the paper's shapes: {:.1g} diagonals\n",
             figures["paper_distance"].get<double>());
  fmt::print("memory held: mesh {:.2f} MB, handles {:.2f} MB; paper {:.2f} MB\n",
             megabytes("mesh_bytes"), megabytes("handles_bytes"), megabytes("paper_bytes"));
  fmt::print("update over two plain reads of the factor ({} ms): {:.2f}\n",
             Milliseconds(figures, "floor_us"), figures["update_over_floor"].get<double>());
}

}  // namespace arap::bench
