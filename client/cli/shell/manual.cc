#include "client/cli/shell/manual.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "client/cli/exit_code.h"
#include "client/cli/help.h"
#include "client/cli/settings.h"

namespace arap::cli {
namespace {

// Text as roff prints it: backslashes and hyphens as they are typed, what is beyond ASCII by its number,
// and no line that begins like a request.
std::string Escaped(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const bool line_begins = i == 0 || text[i - 1] == '\n';
    if (line_begins && (text[i] == '.' || text[i] == '\'')) out += "\\&";
    if (text[i] == '\\') {
      out += "\\e";
    } else if (text[i] == '-') {
      out += "\\-";
    } else if (byte < 0x80) {
      out += text[i];
    } else {
      const std::size_t more = byte >= 0xf0 ? 3 : byte >= 0xe0 ? 2 : 1;
      std::uint32_t point = byte & (0x3fU >> more);
      for (std::size_t k = 1; k <= more && i + k < text.size(); ++k) {
        point = point << 6U | (static_cast<unsigned char>(text[i + k]) & 0x3fU);
      }
      i += more;
      out += fmt::format("\\[u{:04X}]", point);
    }
  }
  return out;
}

std::string Section(std::string_view title) { return fmt::format(".SH {}\n", title); }

std::string Tagged(const std::string& tag, const std::string& text) {
  return ".TP\n" + tag + "\n" + (text.empty() ? "\\&" : Escaped(text)) + "\n";
}

std::string TagOf(const OptionText& option) {
  std::string tag = "\\fB" + Escaped(option.names) + "\\fR";
  if (!option.value.empty()) tag += " \\fI" + Escaped(option.value) + "\\fR";
  if (option.required && !option.positional) tag += " (required)";
  return tag;
}

// Lines that begin with a space are kept as they are; the others are words.
std::string Body(const std::string& text) {
  std::string out;
  bool kept = false;
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    const bool keep = line.starts_with(' ');
    if (keep != kept) out += keep ? ".PP\n.nf\n" : ".fi\n.PP\n";
    kept = keep;
    out += Escaped(line) + "\n";
  }
  return kept ? out + ".fi\n" : out;
}

std::string Sentence(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
  while (text.ends_with('.')) text.pop_back();
  return text;
}

void AddPages(const CLI::App& command, std::vector<std::string>& words, const std::string& version,
              std::vector<ManPage>& pages) {
  pages.push_back(ManPageOf(command, words, version));
  for (const CLI::App* inner : CommandsOf(command)) {
    words.push_back(inner->get_name());
    AddPages(*inner, words, version, pages);
    words.pop_back();
  }
}

}  // namespace

ManPage ManPageOf(const CLI::App& command, const std::vector<std::string>& words,
                  const std::string& version) {
  std::vector<std::string> all{"arapctl"};
  all.insert(all.end(), words.begin(), words.end());
  ManPage page{fmt::format("{}", fmt::join(all, "-")), {}};
  std::string title = page.name;
  for (char& c : title) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::string& text = page.text;
  text = fmt::format(".TH {} 1 \"\" \"arapd {}\" \"User Commands\"\n", Escaped(title), version);
  text += Section("NAME") + Escaped(page.name) + " \\- " +
          Escaped(Sentence(command.get_description())) + "\n";
  text += Section("SYNOPSIS") + "\\fB" +
          Escaped(UsageOf(command, fmt::format("{}", fmt::join(all, " ")))) + "\\fR\n";
  const std::vector<const CLI::App*> commands = CommandsOf(command);
  if (!commands.empty()) text += Section("COMMANDS");
  for (const CLI::App* one : commands) {
    text += Tagged(fmt::format("\\fB{}\\-{}\\fR(1)", Escaped(page.name), Escaped(one->get_name())),
                   one->get_description());
  }
  const std::vector<OptionSection> sections = SectionsOf(command);
  if (!sections.empty()) text += Section("OPTIONS");
  for (const OptionSection& section : sections) {
    if (section.title != "Options") text += ".SS " + Escaped(section.title) + "\n";
    for (const OptionText& option : section.options) text += Tagged(TagOf(option), option.help);
  }
  if (!words.empty() && !command.get_footer().empty()) {
    text += Section("EXAMPLES") + Body(command.get_footer());
  }
  if (words.empty()) {
    text += Section("EXIT STATUS");
    for (const ExitClass& one : ExitClasses()) {
      text += Tagged(
          fmt::format("\\fB{}\\fR {}", static_cast<int>(one.exit), Escaped(std::string(one.name))),
          std::string(one.meaning));
    }
    text += Section("ENVIRONMENT");
    for (const Setting& setting : Settings()) {
      text += Tagged("\\fB" + VariableOf(setting.key) + "\\fR", std::string(setting.meaning));
    }
    text += Tagged("\\fBARAPCTL_TOKEN\\fR", "the bearer token itself, where no file is named");
    text += Tagged("\\fBARAPCTL_CONFIG\\fR", "the config file");
    text += Tagged("\\fBNO_COLOR\\fR", "no colours, also on a terminal");
    text +=
        Section("FILES") +
        Tagged("\\fI~/.config/arapctl/config\\fR",
               "lines KEY = VALUE; the keys are the names of the variables without ARAPCTL_, in "
               "small letters and with hyphens: server, token-file, tls-ca. A flag goes before "
               "the environment, and the environment before the file.");
  }
  text += Section("SEE ALSO") + (words.empty() ? "arapd(1)\n" : "\\fBarapctl\\fR(1)\n");
  return page;
}

std::vector<ManPage> ManPages(const CLI::App& app, const std::string& version) {
  std::vector<ManPage> pages;
  std::vector<std::string> words;
  AddPages(app, words, version, pages);
  return pages;
}

}  // namespace arap::cli
