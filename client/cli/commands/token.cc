// arapctl token: the bearer tokens that a server accepts.
#include "core/token/token.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "client/cli/commands/commands.h"
#include "client/cli/reply.h"
#include "client/cli/report.h"
#include "core/base/names.h"
#include "core/base/try.h"
#include "core/files/text_file.h"

namespace arap::cli {
namespace {

struct TokenFlags {
  std::string file;
  std::string owner;
  std::string role = NameOf(TokenRole::kUser);
  int expires_days = 0;  // 0: never
  std::map<std::string, std::uint64_t> limits, user_limits;
  std::string id;
  bool json = false;
};

std::string CheckOwner(const std::string& owner) {
  if (owner == kNobody) return "anonymous is the name of those who give no identity";
  return IsName(owner) ? "" : "an owner is " + std::string(kNameRule);
}

Result<std::vector<RawTokenEntry>> ReadRawEntries(const std::string& path) {
  TRY(const std::string text, ReadTextFile(path));
  return ParseRawTokenFile(text, path);
}

Result<Reply> Add(const TokenFlags& flags) {
  TRY(const NewToken token, MakeToken());
  TokenEntry entry;
  entry.id = token.id;
  entry.owner = flags.owner;
  entry.role = TokenRoleOf(flags.role).value_or(TokenRole::kUser);
  entry.salt = token.salt;
  entry.sha256 = token.sha256;
  entry.limits = flags.limits;
  entry.user_limits = flags.user_limits;
  if (entry.role != TokenRole::kGateway && !entry.user_limits.empty()) {
    return Fail(FaultKind::kInvalidOption, "Limits of users are for tokens with --role gateway.");
  }
  if (flags.expires_days > 0) {
    entry.expires = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()) +
                    std::chrono::days(flags.expires_days);
  }
  // A damaged file is refused.
  const auto append = [&](const std::optional<std::string>& text) -> Result<std::string> {
    std::vector<TokenEntry> entries;
    if (text) {
      TRY(entries, ParseTokenFile(*text, flags.file));
    }
    entries.push_back(entry);
    return FormatTokenFile(entries);
  };
  CHECK_OK(ChangeTokenFile(flags.file, append));
  fmt::print(stderr, "arapctl: this is the only time that the token is shown; {} has its hash\n",
             flags.file);
  return Reply{{{"token", token.text}, {"id", token.id}, {"owner", flags.owner}},
               token.text + "\n"};
}

Result<Reply> List(const TokenFlags& flags) {
  TRY(const auto entries, ReadRawEntries(flags.file));
  Reply answer{{{"tokens", OrderedJson::array()}}, {}};
  auto out = std::back_inserter(answer.text);
  for (const RawTokenEntry& raw : entries) {
    OrderedJson& json =
        answer.json["tokens"].emplace_back(OrderedJson{{"id", raw.id}, {"owner", raw.owner}});
    if (!raw.entry) {
      json["damaged"] = raw.entry.error().message;
      const auto shown = [](const std::string& text) { return IsName(text) ? text : Quote(text); };
      fmt::format_to(out, "{} {} damaged: {}\n", shown(raw.id), shown(raw.owner),
                     raw.entry.error().message);
      continue;
    }
    const TokenEntry& entry = *raw.entry;
    const std::string expires = entry.expires ? FormatExpiry(*entry.expires) : "never";
    json["role"] = NameOf(entry.role);
    json["expires"] = expires;
    json["limits"] = entry.limits;
    json["user_limits"] = entry.user_limits;
    fmt::format_to(out, "{} {} {} {}", entry.id, entry.owner, NameOf(entry.role), expires);
    for (const auto& [name, value] : entry.limits) fmt::format_to(out, " {}={}", name, value);
    for (const auto& [name, value] : entry.user_limits) {
      fmt::format_to(out, " user_{}={}", name, value);
    }
    answer.text += '\n';
  }
  return answer;
}

Result<Reply> Revoke(const TokenFlags& flags) {
  const bool by_id = !flags.id.empty();
  const std::string& wanted = by_id ? flags.id : flags.owner;
  std::size_t count = 0;
  std::string left_over;
  const auto erase = [&](const std::optional<std::string>& text) -> Result<std::string> {
    if (!text) return ReadTextFile(flags.file);  // says that it is not there
    TRY(auto entries, ParseRawTokenFile(*text, flags.file));
    count = std::erase_if(entries, [&](const RawTokenEntry& raw) {
      // A damaged entry without a name is not the one that is wanted by an empty argument.
      return !wanted.empty() && (by_id ? raw.id : raw.owner) == wanted;
    });
    if (count == 0) return Fail(FaultKind::kNotFound, flags.file + " has no such token.");
    return left_over = FormatRawTokenFile(entries);
  };
  CHECK_OK(ChangeTokenFile(flags.file, erase));
  fmt::print(stderr, "arapctl: {} revoked\n", Numbered(count, "token"));
  if (const auto left = ParseTokenFile(left_over, flags.file); !left) {
    fmt::print(stderr, "arapctl: {} A server keeps its old tokens until that is mended.\n",
               left.error().message);
  }
  return Reply{{{"revoked", count}}, {}};
}

CLI::App* AddAction(CLI::App& token, const char* name, const char* help,
                    const std::shared_ptr<TokenFlags>& flags, Run& run,
                    Result<Reply> (*action)(const TokenFlags&)) {
  CLI::App* const command = token.add_subcommand(name, help);
  command->add_option("--file", flags->file, "the server's token file")
      ->required()
      ->option_text("FILE.json");
  SetReply(*command, run, flags, action);
  return command;
}

}  // namespace

void AddToken(CLI::App& app, Run& run) {
  const auto flags = std::make_shared<TokenFlags>();
  CLI::App* const token = app.add_subcommand("token", "Bearer tokens in a server's token file");
  token->require_subcommand(1);

  CLI::App* const add =
      AddAction(*token, "add", "Make a token, print it once and keep its hash", flags, run, &Add);
  add->add_option("--owner", flags->owner, "whose sessions it sees")
      ->required()
      ->check(CheckOwner)
      ->option_text("NAME");
  add->add_option("--role", flags->role,
                  "user; or admin, who also lists and ends others' sessions; or gateway, which "
                  "names the user "
                  "of each call in the header x-arapd-owner")
      ->check(
          CLI::IsMember(std::vector<std::string>(std::begin(kTokenRoles), std::end(kTokenRoles))))
      ->option_text("user|admin|gateway");
  add->add_option("--expires-days", flags->expires_days, "how long it holds (default: for ever)")
      ->check(CLI::Range(1, 36'500))
      ->option_text("DAYS");
  for (const LimitInfo& info : kLimits) {
    const std::string_view limit = TokenName(info);
    if (limit.empty()) continue;
    const std::string field(limit);
    std::string flag = field;
    std::replace(flag.begin(), flag.end(), '_', '-');
    const auto option = [&](const std::string& name, auto member, const char* help) {
      add->add_option_function<std::uint64_t>(
             name,
             [flags, field, member](std::uint64_t value) { ((*flags).*member)[field] = value; },
             help)
          // Reading it as a number without sign would take -1 for a very large one.
          ->check(CLI::Range(std::int64_t{0}, std::numeric_limits<std::int64_t>::max()))
          ->option_text("N")
          ->group("Limits");
    };
    option("--" + flag, &TokenFlags::limits,
           "limit of its owner, of a gateway with all its users (default: the server's)");
    option("--user-" + flag, &TokenFlags::user_limits,
           "limit of each user of a gateway (default: the server's)");
  }

  AddAction(*token, "list", "id, owner, role, expiry and limits, a line for each", flags, run,
            &List);

  CLI::App* const revoke =
      AddAction(*token, "revoke", "Remove tokens; the server ends their streams within seconds",
                flags, run, &Revoke);
  auto* const which = revoke->add_option_group("Which");
  which->add_option("--id", flags->id, "the one of this id")->option_text("ID");
  which->add_option("--owner", flags->owner, "all of this owner")->option_text("NAME");
  which->require_option(1);
}

}  // namespace arap::cli
