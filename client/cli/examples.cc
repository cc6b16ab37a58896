#include "client/cli/examples.h"

#include <algorithm>
#include <string>
#include <vector>

namespace arap::cli {
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
