#include "client/cli/help.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

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

namespace {

constexpr Example kExamples[] = {
    {"info",
     "arapctl info --server 127.0.0.1:50051\n"
     "arapctl info --spawn --json"},
    {"bake",
     "arapctl bake bear.obj wave.json --out shapes.csv --spawn\n"
     "arapctl bake bear.obj wave.json --out shapes.csv --svg wave.svg --hard \\\n"
     "  --server unix:/run/arapd.sock"},
    {"drag",
     "arapctl drag bear.obj wave.json --server 127.0.0.1:50051\n"
     "arapctl drag bear.obj wave.json --pick 0,50 --json times.json --spawn"},
    {"flatten",
     "arapctl flatten skirt.obj --out uv.obj --report report.json --spawn\n"
     "arapctl flatten skirt.obj --unit cm --paper A4 --pdf pages.pdf --spawn\n"
     "arapctl flatten skirt.obj --unit cm --allowance 10 --dxf pattern.dxf --spawn"},
    {"mesh",
     "arapctl mesh figure.png --out figure.obj --density 2000\n"
     "arapctl mesh scan.png --background auto --expansion 2 --out figure.obj"},
    {"mesh register", "arapctl mesh register work/bear bear.obj --weld --server 127.0.0.1:50051"},
    {"mesh list", "arapctl mesh list work --server 127.0.0.1:50051"},
    {"mesh show", "arapctl mesh show work/bear --json --server 127.0.0.1:50051"},
    {"mesh delete", "arapctl mesh delete work/bear --server 127.0.0.1:50051"},
    {"session create",
     "arapctl session create work --ttl 86400 --label user=ann \\\n"
     "  --server 127.0.0.1:50051"},
    {"session list", "arapctl session list --server 127.0.0.1:50051"},
    {"session show", "arapctl session show work --server 127.0.0.1:50051"},
    {"session delete", "arapctl session delete work --server 127.0.0.1:50051"},
    {"handles compile",
     "arapctl handles compile work/puppet bear wave.json --server 127.0.0.1:50051"},
    {"handles list", "arapctl handles list work --server 127.0.0.1:50051"},
    {"handles show", "arapctl handles show work/puppet --server 127.0.0.1:50051"},
    {"handles edit",
     "arapctl handles edit work/puppet --remove head --add more.json \\\n"
     "  --server 127.0.0.1:50051"},
    {"handles delete", "arapctl handles delete work/puppet --server 127.0.0.1:50051"},
    {"handles pick",
     "arapctl handles pick work/puppet --pick 0,50 --target head=0,190 \\\n"
     "  --server 127.0.0.1:50051"},
    {"watch",
     "arapctl watch 127.0.0.1:35193\n"
     "arapctl watch 127.0.0.1:35193 --once --json"},
    {"load",
     "arapctl load --streams 8 --seconds 10 --vertices 10000 --spawn\n"
     "arapctl load --rate 500 --arrivals poisson --warm-up 2 --spawn\n"
     "arapctl load --search \"p99<20ms\" --seconds 5 --warm-up 1 --spawn\n"
     "arapctl load --fps 60 --server 127.0.0.1:50051 --json a.json --html a.html\n"
     "arapctl load --spawn --threshold \"p99<20ms\" --threshold \"errors<0.1%\""},
    {"load compare",
     "arapctl load compare before.json after.json\n"
     "arapctl load compare before.json after.json --threshold \"p99<5%\""},
    {"token add",
     "arapctl token add --file tokens.json --owner alice --expires-days 90\n"
     "arapctl token add --file tokens.json --owner shop --role gateway \\\n"
     "  --max-sessions 500 --user-max-sessions 5"},
    {"token list", "arapctl token list --file tokens.json"},
    {"token revoke",
     "arapctl token revoke --file tokens.json --id 3f9c2b7a\n"
     "arapctl token revoke --file tokens.json --owner alice"},
    {"plan",
     "arapctl plan --puppets 10000 --vertices 1000 --fps 30\n"
     "arapctl plan --puppets 1000000 --vertices 300 --fps 10 --meshes 5000 \\\n"
     "  --cores 64 --memory 256 --json"},
    {"init-tls",
     "arapctl init-tls tls\n"
     "arapctl init-tls tls --host arapd.example.org --client alice --client bob"},
    {"sample character", "arapctl sample character --out bear.obj --track wave.json"},
    {"sample garment", "arapctl sample garment --out skirt.obj"},
    {"sample face", "arapctl sample face --edge 1 --out face.obj"},
    {"sample grid", "arapctl sample grid --size 30 --out grid.obj --track grid.json"},
    {"figures", "arapctl figures --out . --spawn"},
    {"help", "arapctl help token add"},
    {"completion",
     "source <(arapctl completion bash)   # in ~/.bashrc\n"
     "arapctl completion zsh > ~/.zfunc/_arapctl\n"
     "arapctl completion fish > ~/.config/fish/completions/arapctl.fish"},
    {"man",
     "arapctl man flatten | man -l -\n"
     "arapctl man --out share/man/man1"},
};

}  // namespace

std::span<const Example> Examples() { return kExamples; }

void AddExamples(CLI::App& app) {
  for (const Example& example : kExamples) {
    CLI::App* command = &app;
    std::string_view path = example.command;
    while (command != nullptr && !path.empty()) {
      const std::size_t end = std::min(path.find(' '), path.size());
      const std::vector<CLI::App*> named = command->get_subcommands(
          [&](const CLI::App* one) { return one->get_name() == path.substr(0, end); });
      command = named.empty() ? nullptr : named.front();
      path.remove_prefix(std::min(end + 1, path.size()));
    }
    if (command == nullptr) continue;
    std::string text =
        example.lines.find('\n') == std::string_view::npos ? "Example:" : "Examples:";
    std::string_view lines = example.lines;
    while (!lines.empty()) {
      const std::size_t end = std::min(lines.find('\n'), lines.size());
      text.append("\n  ").append(lines.substr(0, end));
      lines.remove_prefix(std::min(end + 1, lines.size()));
    }
    command->footer(text);
  }
}

}  // namespace arap::cli
