#include "client/cli/help.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "client/cli/exit_code.h"
#include "client/cli/terminal.h"

namespace arap::cli {
namespace {

constexpr std::size_t kColumn = 26;  // where the second one begins

OptionText TextOf(const CLI::Option& option) {
  OptionText text;
  text.positional = !option.nonpositional();
  text.names = option.get_name(text.positional, !text.positional);
  text.required = option.get_required();
  text.help = option.get_description();
  text.value = option.get_option_text();
  // Some say themselves that they are required.
  constexpr std::string_view kRequired = " REQUIRED";
  if (text.value.ends_with(kRequired)) {
    text.value.resize(text.value.size() - kRequired.size());
    text.required = true;
  }
  if (text.value.empty() && !text.positional && option.get_type_size() != 0 &&
      option.get_expected_max() != 0) {
    text.value = option.get_type_name();
    for (char& c : text.value) c = c == ' ' ? '_' : c;
  }
  return text;
}

std::string TitleOf(const CLI::App& group) {
  std::string title = group.get_group();
  constexpr std::string_view kOuter = "[Option Group: ";
  if (title.starts_with(kOuter)) {
    title = title.substr(kOuter.size(), title.size() - kOuter.size() - 1);
  }
  if (!group.get_description().empty()) title += ": " + group.get_description();
  if (group.get_require_option_min() == 1 && group.get_require_option_max() == 1) {
    title += " (exactly one)";
  }
  return title;
}

// The options of one app, by their groups; those of the nameless apps in it follow.
void AddSections(const CLI::App& app, const std::string& title,
                 std::vector<OptionSection>& sections) {
  for (const std::string& group : app.get_groups()) {
    OptionSection section{group == "Options" ? title : group, {}};
    for (const CLI::Option* option : app.get_options()) {
      // Groups have a help option of their own, which is that of the command again.
      const bool again = app.get_name().empty() && option == app.get_help_ptr();
      if (option->get_group() == group && option->nonpositional() && !again) {
        section.options.push_back(TextOf(*option));
      }
    }
    if (!group.empty() && !section.options.empty()) sections.push_back(std::move(section));
  }
  for (const CLI::App* inner : app.get_subcommands({})) {
    if (inner->get_name().empty()) AddSections(*inner, TitleOf(*inner), sections);
  }
}

// Two columns; a left one that is too long has a line to itself.
std::string Row(const std::string& left, const std::string& right) {
  std::string lines = Wrapped(right, kLineWidth, kColumn);
  const std::size_t width = CharactersIn(left);
  if (width + 4 > kColumn || lines.empty()) return "  " + left + "\n" + lines;
  return "  " + left + std::string(kColumn - 2 - width, ' ') + lines.substr(kColumn);
}

// Long lists of choices are broken between them.
std::string LeftOf(const OptionText& option) {
  std::string left = option.names;
  if (const std::size_t comma = left.find(','); comma != std::string::npos)
    left.insert(comma + 1, " ");
  if (!option.value.empty()) left += " " + option.value;
  if (option.required && !option.positional) left += " (required)";
  if (CharactersIn(left) + 2 <= kLineWidth) return left;
  std::string lines, line = option.names + " ";
  std::string_view rest = option.value;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('|'), rest.size() - 1) + 1;
    if (CharactersIn(line) + end + 2 > kLineWidth) {
      lines += line + "\n";
      line = "      ";
    }
    line += rest.substr(0, end);
    rest.remove_prefix(end);
  }
  return lines + line;
}

std::string Heading(const std::string& text) {
  const std::string lines = Wrapped(text + ":", kLineWidth);
  return "\n" + Styled(STDOUT_FILENO, Look::kStrong, lines.substr(0, lines.size() - 1)) + "\n";
}

}  // namespace

std::vector<OptionSection> SectionsOf(const CLI::App& command) {
  std::vector<OptionSection> sections;
  OptionSection arguments{"Arguments", {}};
  for (const CLI::Option* option : command.get_options()) {
    if (!option->nonpositional()) arguments.options.push_back(TextOf(*option));
  }
  if (!arguments.options.empty()) sections.push_back(std::move(arguments));
  AddSections(command, "Options", sections);
  return sections;
}

std::vector<const CLI::App*> CommandsOf(const CLI::App& command) {
  std::vector<const CLI::App*> commands = command.get_subcommands(
      [](const CLI::App* one) { return !one->get_name().empty() && !one->get_group().empty(); });
  return commands;
}

std::string UsageOf(const CLI::App& command, const std::string& name) {
  std::string usage = name;
  if (command.get_require_subcommand_min() > 0) return usage + " COMMAND";
  usage += " [OPTIONS]";
  for (const CLI::Option* option : command.get_options()) {
    if (option->nonpositional()) continue;
    std::string word = option->get_name(true, false);
    if (option->get_expected_max() >= CLI::detail::expected_max_vector_size) word += "...";
    usage += TextOf(*option).required ? " " + word : " [" + word + "]";
  }
  return usage;
}

std::string ExitCodeLines() {
  std::string lines;
  for (const ExitClass& one : ExitClasses()) {
    lines += fmt::format("  {:<4} {:<12} {}\n", static_cast<int>(one.exit), one.name, one.meaning);
  }
  return lines;
}

std::string Help::make_help(const CLI::App* command, std::string name,
                            CLI::AppFormatMode /*mode*/) const {
  std::string text = Styled(STDOUT_FILENO, Look::kStrong, "Usage:") + " ";
  text += Wrapped(UsageOf(*command, name), kLineWidth - 7) + "\n";
  text += Wrapped(command->get_description(), kLineWidth);
  const std::vector<const CLI::App*> commands = CommandsOf(*command);
  if (!commands.empty()) text += Heading("Commands");
  for (const CLI::App* one : commands) text += Row(one->get_name(), one->get_description());
  for (const OptionSection& section : SectionsOf(*command)) {
    text += Heading(section.title);
    for (const OptionText& option : section.options) text += Row(LeftOf(option), option.help);
  }
  const std::string footer = command->get_footer();
  if (!footer.empty()) text += "\n" + Wrapped(footer, kLineWidth);
  return text;
}

}  // namespace arap::cli
