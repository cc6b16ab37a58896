#include "client/cli/connect/token_file.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <openssl/evp.h>
#include <openssl/rand.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/files/text_file.h"

namespace arap::cli {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kIdBytes = 16;
constexpr std::size_t kSaltBytes = 16;
constexpr std::size_t kSecretBytes = 32;

std::string Hex(const unsigned char* bytes, std::size_t count) {
  std::string hex;
  for (std::size_t i = 0; i < count; ++i) hex += fmt::format("{:02x}", bytes[i]);
  return hex;
}

Result<std::string> RandomHex(std::size_t count) {
  std::array<unsigned char, kSecretBytes> bytes{};
  if (RAND_bytes(bytes.data(), static_cast<int>(count)) != 1) {
    return Fail(FaultKind::kInternal, "the system gives no random numbers");
  }
  return Hex(bytes.data(), count);
}

std::string Sha256Hex(const std::string& text) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  if (EVP_Digest(text.data(), text.size(), digest.data(), &size, EVP_sha256(), nullptr) != 1) {
    size = 0;
  }
  return Hex(digest.data(), size);
}

Fault Bad(const std::string& path, const std::string& why) {
  return Fault(FaultKind::kInvalidOption, fmt::format("{}: {}", path, why));
}

auto SystemFault(const std::string& path) {
  return Fail(FaultKind::kInternal,
              fmt::format("cannot write {}: {}", path, std::generic_category().message(errno)));
}

ordered_json ToJson(const TokenEntry& entry) {
  ordered_json json{{"id", entry.id},
                    {"owner", entry.owner},
                    {"role", entry.role},
                    {"salt", entry.salt},
                    {"sha256", entry.sha256}};
  if (!entry.expires.empty()) json["expires"] = entry.expires;
  if (!entry.limits.empty()) json["limits"] = entry.limits;
  return json;
}

// False for what we could not write back as it was.
bool FromJson(const ordered_json& json, TokenEntry& entry) {
  if (!json.is_object()) return false;
  for (const auto& [name, value] : json.items()) {
    if (name == "limits" && value.is_object()) {
      for (const auto& [limit, number] : value.items()) {
        if (!number.is_number_unsigned()) return false;
        entry.limits[limit] = number.get<std::uint64_t>();
      }
      continue;
    }
    if (!value.is_string()) return false;
    std::string* const field = name == "id"        ? &entry.id
                               : name == "owner"   ? &entry.owner
                               : name == "role"    ? &entry.role
                               : name == "salt"    ? &entry.salt
                               : name == "sha256"  ? &entry.sha256
                               : name == "expires" ? &entry.expires
                                                   : nullptr;
    if (field == nullptr) return false;
    *field = value.get<std::string>();
  }
  return !entry.id.empty();
}

// Everything, then onto the disk.
bool WriteAll(int descriptor, const std::string& text) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t count = write(descriptor, text.data() + done, text.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    done += static_cast<std::size_t>(count);
  }
  return fsync(descriptor) == 0;
}

bool LikeTheOldOne(int descriptor, const std::string& path) {
  struct stat old {};
  if (stat(path.c_str(), &old) != 0) return true;  // mkstemp made it 0600
  // Without the right to give files away it stays ours.
  if (fchown(descriptor, old.st_uid, old.st_gid) != 0 && errno != EPERM) return false;
  constexpr mode_t kOthers = S_IRWXO | S_IWGRP | S_IXGRP | S_IXUSR;
  return fchmod(descriptor, old.st_mode & 0777 & ~kOthers) == 0;
}

}  // namespace

Result<NewToken> MakeToken(std::string owner) {
  const auto id = RandomHex(kIdBytes), salt = RandomHex(kSaltBytes),
             secret = RandomHex(kSecretBytes);
  if (!id || !salt || !secret)
    return Fail(!id ? id.error() : !salt ? salt.error() : secret.error());
  NewToken token;
  token.text = "arapd_" + *id + "_" + *secret;
  token.entry = {*id, std::move(owner), "user", *salt, Sha256Hex(*salt + *secret), {}, {}};
  if (token.entry.sha256.empty()) return Fail(FaultKind::kInternal, "SHA-256 is not to be had");
  return token;
}

std::string ExpiryAfter(int days) {
  const auto then = std::chrono::system_clock::now() + std::chrono::hours(24) * days;
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(then)));
}

Result<std::vector<TokenEntry>> ReadTokenFile(const std::string& path, bool must_exist) {
  if (!must_exist && access(path.c_str(), F_OK) != 0 && errno == ENOENT) {
    return std::vector<TokenEntry>();
  }
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return Fail(text.error());
  const ordered_json json = ordered_json::parse(*text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_array()) return Fail(Bad(path, "is no token file, which is a JSON array"));
  std::vector<TokenEntry> entries(json.size());
  for (std::size_t i = 0; i < json.size(); ++i) {
    if (!FromJson(json[i], entries[i])) {
      return Fail(Bad(path, fmt::format("entry {} is no token", i)));
    }
  }
  return entries;
}

Status WriteTokenFile(const std::string& path, const std::vector<TokenEntry>& entries) {
  ordered_json json = ordered_json::array();
  for (const TokenEntry& entry : entries) json.push_back(ToJson(entry));
  std::string fresh = path + ".XXXXXX";
  const int descriptor = mkstemp(fresh.data());
  if (descriptor < 0) return SystemFault(path);
  const bool written = LikeTheOldOne(descriptor, path) && WriteAll(descriptor, json.dump(2) + "\n");
  const bool closed = close(descriptor) == 0;
  if (written && closed && rename(fresh.c_str(), path.c_str()) == 0) return {};
  auto fault = SystemFault(path);
  unlink(fresh.c_str());
  return fault;
}

}  // namespace arap::cli
