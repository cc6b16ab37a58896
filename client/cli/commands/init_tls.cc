// arapctl init-tls: certificates to try TLS with, made by an authority of their own.
#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "client/cli/commands/commands.h"
#include "client/cli/reply.h"
#include "client/cli/report.h"
#include "core/base/files.h"
#include "core/base/names.h"
#include "core/base/try.h"
#include "core/token/authority.h"

namespace arap::cli {
namespace {

// What clients know this machine by.
constexpr std::array<const char*, 3> kLoopback{"localhost", "127.0.0.1", "::1"};
constexpr const char* kAuthorityName = "ca";
constexpr const char* kServerName = "server";

struct TlsFilesFlags {
  std::string directory;
  std::vector<std::string> hosts;
  std::vector<std::string> clients{"client"};
  int days = 365;
  bool json = false;
};

struct NewFile {
  std::string path;
  std::string text;
  mode_t mode;
};

std::string CheckHost(const std::string& host) {
  if (IsAddress(host) || IsHostName(host)) return {};
  return Printable(host) + " is neither host name nor IP address";
}

// Its file is named by it, and the server takes the common name for the owner.
std::string CheckClient(const std::string& owner) {
  constexpr std::size_t kLongest = 64;
  if (owner == kNobody) return "anonymous is the name of those who give no identity";
  if (owner == kAuthorityName || owner == kServerName) return owner + " is a file of its own here";
  if (!IsName(owner) || owner.front() == '.') return "an owner is " + std::string(kNameRule);
  return owner.size() <= kLongest ? "" : "a name in a certificate has at most 64 characters";
}

Fault CannotMake(const std::string& path, int error) {
  return Fault(FaultKind::kInternal,
               fmt::format("{} cannot be made: {}.", path, std::system_category().message(error)));
}

// Never in the place of another, and never readable by more than its mode says.
Status WriteNew(const NewFile& file) {
  const File written(open(file.path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, file.mode));
  if (!written) return Fail(CannotMake(file.path, errno));
  int error = fchmod(written.fd(), file.mode) == 0 ? 0 : errno;
  if (error == 0) error = WriteAll(written, file.text);
  if (error == 0 && fsync(written.fd()) != 0) error = errno;
  if (error == 0) return {};
  unlink(file.path.c_str());
  return Fail(CannotMake(file.path, error));
}

// All of them or none.
Status WriteAllNew(const std::string& directory, const std::vector<NewFile>& files) {
  for (const NewFile& file : files) {
    struct stat info {};
    if (lstat(file.path.c_str(), &info) != 0) continue;
    return Fail(FaultKind::kAlreadyExists,
                file.path + " is there already; nothing was made. Name another folder.");
  }
  std::error_code error;
  const bool made = std::filesystem::create_directories(directory, error);
  if (error) return Fail(CannotMake(directory, error.value()));
  // The keys in it are for one user.
  if (made) chmod(directory.c_str(), S_IRWXU);
  for (std::size_t i = 0; i < files.size(); ++i) {
    const Status done = WriteNew(files[i]);
    if (done) continue;
    for (std::size_t k = 0; k < i; ++k) unlink(files[k].path.c_str());
    return done;
  }
  return {};
}

void AddPair(const std::string& base, const Credential& credential, std::vector<NewFile>& files) {
  files.push_back({base + ".crt", credential.certificate, 0644});
  files.push_back({base + ".key", credential.key, 0600});
}

Result<Reply> InitTls(const TlsFilesFlags& flags) {
  const std::chrono::days life(flags.days);
  std::vector<std::string> hosts(kLoopback.begin(), kLoopback.end());
  for (const std::string& host : flags.hosts) {
    if (std::find(hosts.begin(), hosts.end(), host) == hosts.end()) hosts.push_back(host);
  }
  const std::string base = (std::filesystem::path(flags.directory) / "").string();
  const std::string authority_base = base + kAuthorityName, server_base = base + kServerName;
  std::vector<NewFile> files;
  TRY(const Authority authority, Authority::Make("arapd development authority", life));
  AddPair(authority_base, authority.own(), files);
  TRY(const Credential server, authority.ForServer(hosts));
  AddPair(server_base, server, files);
  std::vector<std::string> owners;
  for (const std::string& owner : flags.clients) {
    if (std::find(owners.begin(), owners.end(), owner) != owners.end()) continue;
    owners.push_back(owner);
    TRY(const Credential client, authority.ForClient(owner));
    AddPair(base + owner, client, files);
  }
  CHECK_OK(WriteAllNew(flags.directory, files));

  const std::string server_flags = fmt::format(
      "--tls-cert {0}.crt --tls-key {0}.key --tls-client-ca {1}.crt "
      "--require-client-cert",
      server_base, authority_base);
  const std::string client_flags =
      fmt::format("--tls-ca {0}.crt --tls-cert {1}.crt --tls-key {1}.key", authority_base,
                  base + owners.front());
  const std::string expires = FormatTime(std::chrono::system_clock::now() + life);
  Reply answer{{{"files", OrderedJson::array()},
                {"hosts", hosts},
                {"owners", owners},
                {"expires", expires},
                {"server_flags", server_flags},
                {"client_flags", client_flags}},
               {}};
  auto out = std::back_inserter(answer.text);
  for (const NewFile& file : files) {
    answer.json["files"].push_back(file.path);
    fmt::format_to(out, "{:04o} {}\n", file.mode, Printable(file.path));
  }
  fmt::format_to(out,
                 "\nFor trials: whoever reads {}.key can be everybody. All of them end at {}.\n\n"
                 "arapd {}\narapctl info --server localhost:50051 {}\n",
                 Printable(authority_base), expires, Printable(server_flags),
                 Printable(client_flags));
  return answer;
}

}  // namespace

void AddInitTls(CLI::App& app, Run& run) {
  const auto flags = std::make_shared<TlsFilesFlags>();
  CLI::App* const command = app.add_subcommand(
      "init-tls", "Make an authority with certificates for a server and clients, for development");
  command->add_option("DIR", flags->directory, "the folder for them; nothing in it is replaced")
      ->required();
  command
      ->add_option("--host", flags->hosts,
                   "a name or IP address that the server is reached by, beside localhost, "
                   "127.0.0.1 and ::1; repeatable")
      ->check(CheckHost)
      ->allow_extra_args(false)
      ->option_text("NAME");
  command
      ->add_option("--client", flags->clients,
                   "the owner that a client is by its certificate (default: client); repeatable")
      ->check(CheckClient)
      ->allow_extra_args(false)
      ->option_text("NAME");
  command->add_option("--days", flags->days, "how long they hold (default: 365)")
      ->check(CLI::Range(1, 3'650))
      ->option_text("DAYS");
  SetReply(*command, run, flags, &InitTls);
}

}  // namespace arap::cli
