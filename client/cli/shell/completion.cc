#include "client/cli/shell/completion.h"

#include <algorithm>
#include <cctype>
#include <numeric>
#include <utility>

#include "client/cli/help.h"

namespace arap::cli {
namespace {

// bash cuts "--name=value" into three words.
std::vector<std::string> WithoutCuts(std::span<const std::string> words) {
  std::vector<std::string> whole;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool after_equals = i > 0 && words[i - 1] == "=";
    if (!whole.empty() && whole.back().starts_with("--") && (words[i] == "=" || after_equals)) {
      whole.back() += words[i];
    } else {
      whole.push_back(words[i]);
    }
  }
  return whole;
}

const OptionText* FindOption(const std::vector<OptionSection>& sections, std::string_view name) {
  for (const OptionSection& section : sections) {
    for (const OptionText& option : section.options) {
      std::string_view names = option.names;
      while (!option.positional && !names.empty()) {
        const std::size_t end = std::min(names.find(','), names.size());
        if (names.substr(0, end) == name) return &option;
        names.remove_prefix(std::min(end + 1, names.size()));
      }
    }
  }
  return nullptr;
}

// The first sentence or what is before a semicolon, for a line of a menu.
std::string Short(const std::string& help) {
  std::string text = help.substr(0, std::min(help.find_first_of(";\n"), help.find(". ")));
  constexpr std::size_t kMost = 60;
  if (text.size() > kMost) text.resize(std::min(text.rfind(' ', kMost), kMost));
  return text;
}

void AddCandidate(const std::string& word, const std::string& help, std::string_view begin,
                  const std::string& before, Candidates& to) {
  if (word.starts_with(begin)) to.words.push_back({before + word, Short(help)});
}

// The values of an option: the choices that it lists, or files where it takes one.
void AddValues(const OptionText& option, std::string_view begin, const std::string& before,
               Candidates& to) {
  std::string_view rest = option.value;
  if (rest.find('|') == std::string_view::npos) {
    to.files = rest.find("FILE") != std::string_view::npos || rest == "FOLDER";
    return;
  }
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('|'), rest.size());
    AddCandidate(std::string(rest.substr(0, end)), {}, begin, before, to);
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
}

constexpr std::string_view kBash = R"(# bash completion for arapctl
_arapctl() {
  local kind word help cur=${COMP_WORDS[COMP_CWORD]}
  COMPREPLY=()
  [[ $cur == '=' ]] && cur=
  {
    IFS= read -r kind
    while IFS=$'\t' read -r word help; do
      [[ -n $word ]] && COMPREPLY+=("$word")
    done
  } < <(arapctl __complete -- "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null)
  if [[ $kind == files ]]; then
    compopt -o filenames 2>/dev/null
    while IFS= read -r word; do COMPREPLY+=("$word"); done < <(compgen -f -- "$cur")
  fi
}
complete -F _arapctl arapctl
)";

constexpr std::string_view kZsh = R"(#compdef arapctl
# zsh completion for arapctl
_arapctl() {
  local kind line
  local -a lines candidates
  lines=("${(@f)$(arapctl __complete -- "${(@)words[2,CURRENT]}" 2>/dev/null)}")
  kind=$lines[1]
  for line in "${(@)lines[2,-1]}"; do
    [[ -z $line ]] && continue
    candidates+=("${${line%%$'\t'*}//:/\\:}:${line#*$'\t'}")
  done
  (( $#candidates )) && _describe arapctl candidates
  [[ $kind == files ]] && _files
}
if [ "$funcstack[1]" = "_arapctl" ]; then
  _arapctl "$@"
else
  compdef _arapctl arapctl
fi
)";

constexpr std::string_view kFish = R"(# fish completion for arapctl
function __arapctl_complete
    set -l words (commandline -opc) (commandline -ct)
    set -l lines (arapctl __complete -- $words[2..-1] 2>/dev/null)
    for line in $lines[2..-1]
        echo $line
    end
    if test "$lines[1]" = files
        __fish_complete_path (commandline -ct)
    end
end
complete -c arapctl -f -a '(__arapctl_complete)'
)";

}  // namespace

Candidates Complete(const CLI::App& app, std::span<const std::string> given) {
  Candidates found;
  const std::vector<std::string> words = WithoutCuts(given);
  if (words.empty()) return found;
  const CLI::App* command = &app;
  std::size_t next = 0;
  for (; next + 1 < words.size(); ++next) {
    const CLI::App* inner = nullptr;
    for (const CLI::App* one : CommandsOf(*command)) {
      if (one->get_name() == words[next]) inner = one;
    }
    if (inner == nullptr) break;
    command = inner;
    // What `help` explains are commands.
    if (command->get_name() == "help") command = &app;
  }
  const std::vector<OptionSection> sections = SectionsOf(*command);
  const std::string& last = words.back();
  const OptionText* before =
      words.size() > 1 ? FindOption(sections, words[words.size() - 2]) : nullptr;
  const bool joined = last.starts_with("--") && last.find('=') != std::string::npos;
  if (joined || (before != nullptr && !before->value.empty())) {
    const std::size_t equals = joined ? last.find('=') + 1 : 0;
    const OptionText* option = joined ? FindOption(sections, last.substr(0, equals - 1)) : before;
    // Where bash has cut the word, it wants the part after "=" alone.
    const bool cut = given.size() != words.size();
    if (option != nullptr) {
      AddValues(*option, std::string_view(last).substr(equals), cut ? "" : last.substr(0, equals),
                found);
    }
    return found;
  }
  const std::vector<const CLI::App*> commands = CommandsOf(*command);
  if (last.starts_with('-')) {
    for (const OptionSection& section : sections) {
      for (const OptionText& option : section.options) {
        if (option.positional) continue;
        AddCandidate(option.names.substr(option.names.rfind(',') + 1), option.help, last, {},
                     found);
      }
    }
    return found;
  }
  for (const CLI::App* one : commands)
    AddCandidate(one->get_name(), one->get_description(), last, {}, found);
  if (command->get_require_subcommand_min() > 0) return found;
  for (const OptionSection& section : sections) {
    for (const OptionText& option : section.options) {
      if (!option.positional) continue;
      const bool choice = option.value.find('|') != std::string::npos;
      if (choice) AddValues(option, last, {}, found);
      found.files = found.files || !choice;
    }
  }
  return found;
}

std::string FormatCandidates(const Candidates& candidates) {
  std::string text = candidates.files ? "files\n" : "words\n";
  for (const Candidate& one : candidates.words) text += one.word + "\t" + one.help + "\n";
  return text;
}

std::string_view CompletionScript(std::string_view shell) {
  if (shell == "bash") return kBash;
  if (shell == "zsh") return kZsh;
  if (shell == "fish") return kFish;
  return {};
}

namespace {

char Small(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

}  // namespace

std::size_t Slips(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before, last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = Small(a[i - 1]) == Small(b[j - 1]);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
      if (i > 1 && j > 1 && Small(a[i - 1]) == Small(b[j - 2]) &&
          Small(a[i - 2]) == Small(b[j - 1])) {
        row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
    before = std::exchange(last, row);
  }
  return last.back();
}

std::vector<std::string> Nearest(std::string_view word, const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 3;
  // "--t" is the beginning of too much to say anything.
  const std::size_t dashes = std::min(word.find_first_not_of('-'), word.size());
  std::vector<std::string> found;
  if (word.size() - dashes >= 2) {
    for (const std::string& name : names) {
      if (std::string_view(name).starts_with(word)) found.push_back(name);
    }
  }
  if (!found.empty() && found.size() <= kMost) return found;
  found.clear();
  std::size_t least = std::max<std::size_t>(1, (word.size() - dashes) / 3);
  for (const std::string& name : names) {
    const std::size_t slips = Slips(word, name);
    if (slips > least) continue;
    if (slips < least) found.clear();
    least = slips;
    found.push_back(name);
  }
  if (found.size() > kMost) found.resize(kMost);
  return found;
}

std::string DidYouMean(std::string_view word, const std::vector<std::string>& names) {
  const std::vector<std::string> near = Nearest(word, names);
  std::string text;
  for (std::size_t i = 0; i < near.size(); ++i) {
    text += i == 0 ? "" : i + 1 == near.size() ? " or " : ", ";
    text += near[i];
  }
  return text.empty() ? text : "; did you mean " + text + "?";
}

}  // namespace arap::cli
