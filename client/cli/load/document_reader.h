// Reads a JSON document that arapctl has written, and that anybody may have changed since.
#pragma once

#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "arap/base/fault.h"
#include "client/cli/load/histogram.h"

namespace arap::cli {

// What is wrong first is kept, with its place, and then nothing else is read: who reads looks once, at
// the end. A place is a path, "operations.drag.sent"; `path` is that of `object`, empty for the
// document.
class DocumentReader {
 public:
  using Json = nlohmann::ordered_json;

  // kInvalidOption with the path as its field.
  const std::optional<Fault>& fault() const { return fault_; }
  // "PATH what."
  void Wrong(const std::string& path, std::string_view what);

  // The member of that name, or nothing, and it is told; with a type only one that has it.
  const Json* Member(const Json& object, const std::string& path, const std::string& name);
  const Json* Member(const Json& object, const std::string& path, const std::string& name,
                     Json::value_t type);

  // Sets the value from the member of that name: a number from 0 on, true or false, a text (made
  // printable), what a histogram has written, a count.
  void Read(const Json& object, const std::string& path, const std::string& name, double& value);
  void Read(const Json& object, const std::string& path, const std::string& name, bool& value);
  void Read(const Json& object, const std::string& path, const std::string& name,
            std::string& value);
  void Read(const Json& object, const std::string& path, const std::string& name, Histogram& value);
  template <std::unsigned_integral Count>
  void Read(const Json& object, const std::string& path, const std::string& name, Count& value) {
    const Json* const member = Member(object, path, name);
    if (member == nullptr) return;
    if (!member->is_number_unsigned()) return Wrong(Join(path, name), "is no count");
    value = member->get<Count>();
  }

 private:
  static std::string Join(const std::string& path, const std::string& name);

  std::optional<Fault> fault_;
};

}  // namespace arap::cli
