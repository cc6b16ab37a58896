#include "client/cli/commands/commands.h"

#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/base/names.h"
#include "core/files/text_file.h"
#include "core/files/text_scan.h"

namespace arap::cli {
namespace {

// The whole word as a finite number of at least 0.
bool ParseTolerance(const std::string& word, double& tolerance) {
  const Result<double> number = ParseNumber(word);
  tolerance = number.value_or(0);
  return number && tolerance >= 0;
}

// Whether it is a name, or two with a slash between them.
bool HasShape(const std::string& text, bool two, bool both) {
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos) return !(two && both) && IsName(text);
  return two && IsName(text.substr(0, slash)) && IsName(text.substr(slash + 1));
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

CLI::Validator Between(double low, double high) {
  return CLI::Validator(
      [low, high](std::string& text) -> std::string {
        double number = 0;
        const char* const end = text.data() + text.size();
        const auto [stop, error] = std::from_chars(text.data(), end, number);
        if (error == std::errc() && stop == end && number >= low && number <= high) return {};
        return fmt::format("{} is not a number from {} to {}", text, low, high);
      },
      "");
}

void AddMeasureEvery(CLI::App& command, DeformOptions& deform) {
  command
      .add_option("--measure-every", deform.measure_every,
                  "measure every N-th shape alone: its flips, its stretch and its energy; 0: none; "
                  "default 1")
      ->check(Between(0, 1e9))
      ->option_text("N");
}

CLI::Validator Positive() { return Between(1e-9, 1e9); }

CLI::Option* AddOutput(CLI::App& command, const std::string& flag, std::string& path,
                       const std::string& help, const std::string& text) {
  return command.add_option(flag, path, help)
      ->check(CLI::Validator(
          [flag](std::string& name) {
            if (name == kStandardStream) {
              return TakeStandardOutput(flag) ? std::string()
                                              : "standard output is for another option already";
            }
            const Status writable = CheckWritable(name);
            return writable ? std::string() : writable.error().message;
          },
          ""))
      ->option_text(text);
}

std::chrono::milliseconds Timeout::value() const {
  return std::chrono::milliseconds(std::llround(std::ceil(seconds * 1000)));
}

void AddTimeout(CLI::App& command, Timeout& timeout) {
  command
      .add_option("--timeout", timeout.seconds,
                  "give up when the server has sent nothing new for so many seconds; default 600")
      ->check(Positive())
      ->option_text("SECONDS");
}

void AddNamed(CLI::App& command, NamedOptions& options, const std::string& shape,
              const std::string& help) {
  if (!shape.empty()) {
    const bool two = shape.find('/') != std::string::npos;
    const bool both = shape.find('[') == std::string::npos;
    command.add_option(shape, options.name, help)
        ->required()
        ->check(CLI::Validator(
            [shape, two, both](std::string& text) {
              return HasShape(text, two, both)
                         ? std::string()
                         : fmt::format("{} is not {}, where a name is {}", text, shape, kNameRule);
            },
            ""));
  }
  AddServerFlags(command, options.server);
  AddTimeout(command, options.timeout);
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
