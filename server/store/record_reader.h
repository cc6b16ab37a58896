// RecordReader: takes JSON apart without trusting it.
#pragma once

#include <string>
#include <type_traits>
#include <utility>

#include <nlohmann/json.hpp>

namespace arap::store {

// Every read of a value that is missing or of another type leaves its target as it was and makes
// the reader bad for good; so one question at the end is enough. Never throws.
class RecordReader {
 public:
  using Json = nlohmann::json;

  bool good() const { return good_; }
  bool Check(bool condition) {
    good_ = good_ && condition;
    return condition;
  }

  // The member `name`, null when there is none.
  const Json& At(const Json& json, const char* name);
  // The same, an empty array or object when it is nothing of the kind.
  const Json& Array(const Json& json, const char* name);
  const Json& Object(const Json& json, const char* name);

  void Bool(const Json& json, const char* name, bool& value);
  void String(const Json& json, std::string& value);
  void String(const Json& json, const char* name, std::string& value) {
    String(At(json, name), value);
  }
  // A number, or 16 hexadecimal digits with the bits of one that is not finite.
  void Double(const Json& json, double& value);

  // An integer that fits.
  template <class T>
  void Number(const Json& json, const char* name, T& value) {
    static_assert(std::is_integral_v<T>);
    const Json& at = At(json, name);
    if (at.is_number_unsigned()) {
      const auto number = at.get<Json::number_unsigned_t>();
      if (Check(std::in_range<T>(number))) value = static_cast<T>(number);
    } else if (Check(at.is_number_integer())) {
      const auto number = at.get<Json::number_integer_t>();
      if (Check(std::in_range<T>(number))) value = static_cast<T>(number);
    }
  }

 private:
  bool good_ = true;
};

}  // namespace arap::store
