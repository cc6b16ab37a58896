#include "client/cli/commands/named.h"

#include <fmt/format.h>

#include "core/base/names.h"

namespace arap::cli {
namespace {

bool HasShape(const std::string& text, bool two, bool both) {
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos) return !(two && both) && IsName(text);
  return two && IsName(text.substr(0, slash)) && IsName(text.substr(slash + 1));
}

}  // namespace

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

}  // namespace arap::cli
