#include "tests/system/wire/token_fixture.h"

#include <filesystem>
#include <fstream>
#include <utility>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <stdlib.h>

#include "core/token/digest.h"

namespace arap::wire {

TestToken::TestToken(char digit, std::string owner, std::string role)
    : id_(32, digit),
      owner_(std::move(owner)),
      role_(std::move(role)),
      salt_("5a17" + std::string(28, digit)),
      secret_(Sha256Hex("a secret of " + std::string(1, digit)).value()) {}

std::string TestToken::Text() const { return "arapd_" + id_ + "_" + secret_; }

std::string TestToken::hash() const { return Sha256Hex(salt_ + secret_).value(); }

std::string TestToken::Entry(const std::string& more) const {
  nlohmann::json entry{
      {"id", id_}, {"owner", owner_}, {"role", role_}, {"salt", salt_}, {"sha256", hash()}};
  entry.update(nlohmann::json::parse("{" + more + "}"));
  return entry.dump();
}

SecretFolder::SecretFolder() {
  std::string pattern = ::testing::TempDir() + "arapd-secrets-XXXXXX";
  if (mkdtemp(pattern.data()) == nullptr) ADD_FAILURE() << "cannot make " << pattern;
  folder_ = pattern;
}

SecretFolder::~SecretFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

std::string SecretFolder::Put(const std::string& name, const std::string& text) const {
  const std::string fresh = Path(name + ".new");
  std::ofstream(fresh) << text;
  using std::filesystem::perms;
  std::filesystem::permissions(fresh, perms::owner_read | perms::owner_write);
  std::filesystem::rename(fresh, Path(name));
  return Path(name);
}

void SecretFolder::PutTokens(const std::vector<std::string>& entries) const {
  std::string text = "[";
  for (const std::string& entry : entries) text += (text.size() > 1 ? "," : "") + entry;
  Put("tokens.json", text + "]");
}

}  // namespace arap::wire
