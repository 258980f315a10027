#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

namespace mascot {

/// Reads the fields of a JSON object that another process sent, which may be anything. If a field is missing, of
/// another kind or out of range, the whole object is wrong: the reader of the field gets a value in range nevertheless,
/// and mistake() says what was expected first. Texts are as they were sent: the code that prints them makes them safe
/// (Plain()).
class OutsideFields {
 public:
  using Object = nlohmann::ordered_json;

  /// `object` must outlive this object.
  explicit OutsideFields(const Object& object) : object_(object) {}

  /// A text of at most `longest` bytes.
  std::string Text(const char* field, std::size_t longest);
  bool Boolean(const char* field);
  double Number(const char* field, double least, double most);
  std::int64_t Integer(const char* field, std::int64_t least, std::int64_t most);
  /// Whether there is such a field, of whatever kind.
  bool Has(const char* field) const { return Find(field) != nullptr; }
  /// A list of at most `most` values.
  const Object& List(const char* field, std::size_t most);

  /// `expected an integer in [1, 9] as "pid", got "x"`; empty: all fields that were read are as expected.
  const std::string& mistake() const { return mistake_; }
  bool are_good() const { return mistake_.empty(); }
  /// Throws JsonError with mistake(), if there is one.
  void Require() const;

 private:
  const Object* Find(const char* field) const;
  void Refuse(const char* field, const std::string& expected);

  const Object& object_;
  std::string mistake_;
};

}  // namespace mascot
