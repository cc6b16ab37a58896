// The flags that mend a mesh before it is used.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "client/cli/commands/commands.h"
#include "core/files/text_scan.h"

namespace arap::cli {
namespace {

// The whole word as a finite number of at least 0.
bool ParseTolerance(const std::string& word, double& tolerance) {
  const Result<double> number = ParseNumber(word);
  tolerance = number.value_or(0);
  return number && tolerance >= 0;
}

}  // namespace

std::vector<std::string> Joined(std::vector<std::string> words) {
  std::vector<std::string> joined;
  for (std::string& word : words) {
    double tolerance = 0;
    if (!joined.empty() && joined.back() == "--weld" && ParseTolerance(word, tolerance)) {
      joined.back() += "=" + word;
    } else {
      joined.push_back(std::move(word));
    }
  }
  return joined;
}

void AddRepairs(CLI::App& command, RepairOptions& repairs) {
  auto* const group = command.add_option_group("Repair", "what is mended first");
  // Of a flag without a value CLI11 makes the word true.
  const auto text = std::make_shared<std::string>();
  group
      ->add_flag(
          "--weld", *text,
          "join vertices that lie within TOL of one another, in units of the mesh; default a "
          "millionth of its size. --stitch goes by it too")
      ->option_text("[TOL]")
      ->check(CLI::Validator(
          [](std::string& word) {
            double tolerance = 0;
            const bool good = word == "true" || ParseTolerance(word, tolerance);
            return good ? std::string() : word + " is not a length of at least 0";
          },
          ""))
      ->each([&repairs, text](const std::string& word) {
        double tolerance = 0;
        repairs.weld = true;
        if (ParseTolerance(word, tolerance)) repairs.tolerance = tolerance;
      });
  group->add_flag("--stitch", repairs.stitch,
                  "split border edges at vertices of the border that lie on them (T-junctions)");
  group->add_flag(
      "--drop-duplicates", repairs.drop_duplicates,
      "keep one of triangles with the same corners: doubled faces, both sides of a sheet");
}

}  // namespace arap::cli
