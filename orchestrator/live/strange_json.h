#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace mascot {

/// The JSON object in a line that another process sent, which may be anything: nothing if it is none, nested more than
/// a few levels deep, or not in UTF-8. How long lines may be decides who reads them.
std::optional<nlohmann::ordered_json> StrangeJson(std::string_view line);

/// Reads the fields of such an object. What is missing, of another type or out of range spoils the whole.
class StrangeFields {
 public:
  explicit StrangeFields(const nlohmann::ordered_json& object) : object_(object) {}

  /// A text of at most `longest` bytes, fit for a terminal: in one line (PlainLine()), or in several if `lines`.
  std::string Text(const char* field, std::size_t longest, bool lines = false);
  bool Boolean(const char* field);
  double Number(const char* field, double least, double most);
  std::int64_t Integer(const char* field, std::int64_t least, std::int64_t most);

  /// Whether all fields that were read are as expected.
  bool are_good() const { return good_; }

 private:
  const nlohmann::ordered_json* Find(const char* field, bool (*is_right)(const nlohmann::ordered_json&));

  const nlohmann::ordered_json& object_;
  bool good_ = true;
};

}  // namespace mascot
