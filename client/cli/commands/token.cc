// arapctl token: the bearer tokens that a server accepts.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "client/cli/commands/commands.h"
#include "client/cli/connect/token_file.h"
#include "client/cli/report.h"

namespace arap::cli {
namespace {

struct TokenFlags {
  std::string file;
  std::string owner;
  std::string role = "user";
  int expires_days = 0;  // 0: never
  std::map<std::string, std::uint64_t> limits;
  std::string id;
};

// As the server wants names to be.
std::string CheckOwner(const std::string& owner) {
  constexpr const char* kCharacters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-";
  constexpr std::size_t kLongest = 128;
  if (owner == "anonymous") return "anonymous is the name of those who give no identity";
  if (!owner.empty() && owner.size() <= kLongest &&
      owner.find_first_not_of(kCharacters) == std::string::npos) {
    return {};
  }
  return "an owner is 1 to 128 characters of [A-Za-z0-9._-]";
}

Status Add(const TokenFlags& flags) {
  auto entries = ReadTokenFile(flags.file, /*must_exist=*/false);
  if (!entries) return Fail(entries.error());
  auto token = MakeToken(flags.owner);
  if (!token) return Fail(token.error());
  token->entry.role = flags.role;
  token->entry.limits = flags.limits;
  if (flags.expires_days > 0) token->entry.expires = ExpiryAfter(flags.expires_days);
  entries->push_back(token->entry);
  if (auto written = WriteTokenFile(flags.file, *entries); !written) return written;
  fmt::print("{}\n", token->text);
  fmt::print(stderr, "arapctl: this is the only time that the token is shown; {} has its hash\n",
             flags.file);
  return {};
}

Status List(const TokenFlags& flags) {
  const auto entries = ReadTokenFile(flags.file, /*must_exist=*/true);
  if (!entries) return Fail(entries.error());
  for (const TokenEntry& entry : *entries) {
    fmt::print("{} {} {} {}", entry.id, entry.owner, entry.role,
               entry.expires.empty() ? "never" : entry.expires);
    for (const auto& [name, value] : entry.limits) fmt::print(" {}={}", name, value);
    fmt::print("\n");
  }
  return {};
}

Status Revoke(const TokenFlags& flags) {
  auto entries = ReadTokenFile(flags.file, /*must_exist=*/true);
  if (!entries) return Fail(entries.error());
  const auto gone = std::remove_if(entries->begin(), entries->end(), [&](const TokenEntry& entry) {
    return flags.id.empty() ? entry.owner == flags.owner : entry.id == flags.id;
  });
  if (gone == entries->end()) {
    return Fail(FaultKind::kNotFound, flags.file + " has no such token");
  }
  const auto count = entries->end() - gone;
  entries->erase(gone, entries->end());
  if (auto written = WriteTokenFile(flags.file, *entries); !written) return written;
  fmt::print(stderr, "arapctl: {} revoked\n",
             count == 1 ? "1 token" : fmt::format("{} tokens", count));
  return {};
}

CLI::App* AddAction(CLI::App& token, const char* name, const char* help,
                    const std::shared_ptr<TokenFlags>& flags, Run& run,
                    Status (*action)(const TokenFlags&)) {
  CLI::App* const command = token.add_subcommand(name, help);
  command->add_option("--file", flags->file, "the server's token file")->required();
  command->callback([flags, &run, action] {
    run = [flags, action] {
      const Status done = action(*flags);
      return done ? kOk : Complain(done.error());
    };
  });
  return command;
}

}  // namespace

void AddToken(CLI::App& app, Run& run) {
  const auto flags = std::make_shared<TokenFlags>();
  CLI::App* const token = app.add_subcommand("token", "Bearer tokens in a server's token file");
  token->require_subcommand(1);

  CLI::App* const add =
      AddAction(*token, "add", "Make a token, print it once and keep its hash", flags, run, &Add);
  add->add_option("--owner", flags->owner, "whose sessions it sees")->required()->check(CheckOwner);
  add->add_option("--role", flags->role, "user; or admin, who also lists and ends others' sessions")
      ->check(CLI::IsMember({"user", "admin"}))
      ->capture_default_str();
  add->add_option("--expires-days", flags->expires_days, "how long it holds (default: for ever)")
      ->check(CLI::Range(1, 36'500));
  for (const char* limit :
       {"max-sessions", "max-meshes", "max-handle-sets", "max-bytes", "max-streams"}) {
    std::string field = limit;
    std::replace(field.begin(), field.end(), '-', '_');
    add->add_option_function<std::uint64_t>(
           std::string("--") + limit,
           [flags, field](std::uint64_t value) { flags->limits[field] = value; },
           "limit of its owner (default: the server's)")
        // Reading it as a number without sign would take -1 for a very large one.
        ->check(CLI::Range(std::int64_t{0}, std::numeric_limits<std::int64_t>::max()))
        ->group("Limits");
  }

  AddAction(*token, "list", "id, owner, role, expiry and limits, a line for each", flags, run,
            &List);

  CLI::App* const revoke =
      AddAction(*token, "revoke", "Remove tokens; the server ends their streams within seconds",
                flags, run, &Revoke);
  auto* const which = revoke->add_option_group("Which");
  which->add_option("--id", flags->id, "the one of this id");
  which->add_option("--owner", flags->owner, "all of this owner");
  which->require_option(1);
}

}  // namespace arap::cli
