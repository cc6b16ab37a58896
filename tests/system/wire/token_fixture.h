// Tokens and token files for tests.
#pragma once

#include <string>
#include <vector>

namespace arap::wire {

// A token whose id is 32 times `digit`, with a secret of its own.
class TestToken {
 public:
  TestToken(char digit, std::string owner, std::string role = "user");

  // "arapd_ID_SECRET".
  std::string Text() const;
  const std::string& secret() const { return secret_; }
  const std::string& salt() const { return salt_; }
  std::string hash() const;
  // Its object in a file; `more` are members that are added or take the place of others.
  std::string Entry(const std::string& more = {}) const;

 private:
  std::string id_, owner_, role_, salt_, secret_;
};

// A fresh folder for secrets, gone after the test.
class SecretFolder {
 public:
  SecretFolder();
  ~SecretFolder();
  SecretFolder(const SecretFolder&) = delete;
  SecretFolder& operator=(const SecretFolder&) = delete;

  std::string Path(const std::string& name) const { return folder_ + "/" + name; }
  // A new file, mode 0600, that takes the place of an old one at once. Answers its path.
  std::string Put(const std::string& name, const std::string& text) const;

  std::string tokens() const { return Path("tokens.json"); }
  // Puts a token file with these entries.
  void PutTokens(const std::vector<std::string>& entries) const;

 private:
  std::string folder_;
};

}  // namespace arap::wire
