#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "base/value.h"
#include "experiment/toml/section.h"

namespace mascot {

/// Tables of values that stand in no file, change, and are read again: a change costs what its value does, and a reader
/// reads the tables that it asks for, in the words of the file, without any text between. Keys are dotted:
/// "law.p_gain", "agents.override[0].law.p_gain".
class ValueTables {
 public:
  explicit ValueTables(const Value::Table& values);
  ValueTables(const ValueTables& other);
  ValueTables& operator=(const ValueTables& other);
  ~ValueTables();

  bool Has(std::string_view key) const;
  /// The value of `key`; nullopt: there is none.
  std::optional<Value> Get(std::string_view key) const;
  /// Puts a value there, and makes the tables around it that are missing, also one behind the end of a list. Throws
  /// ConfigError, which says `where`, if the key is no dotted one, or leads through what is no table.
  void Set(std::string_view key, const Value& value, const std::string& where);
  void Erase(std::string_view key);
  /// Takes back all Set() and Erase() since the last Keep().
  void Undo();
  void Keep();

  /// The tables as a document whose every place is `where`; valid until they change. It remembers nothing of what is
  /// read: no Resolved(), no AsRead().
  Section Read(const std::string& where) const;

 private:
  struct Content;
  std::unique_ptr<Content> content_;  // never null
};

}  // namespace mascot
