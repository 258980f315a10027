#pragma once

// What section.cc, section_document.cc and section_text.cc share; nobody else includes this, or toml++.

#include <toml++/toml.h>

#include <set>

#include "experiment/section.h"

namespace mascot {

/// What a number may be.
struct NumberRange {
  double min;
  double max;
  bool open_min = false;  ///< `min` itself is refused

  bool Holds(double value) const { return (open_min ? value > min : value >= min) && value <= max; }
  /// A legal value to go on with where a mistake was noted.
  double Legal() const { return Holds(0) ? 0 : max < 0 ? max : open_min ? max : min; }
  std::string Text() const;  ///< "[0, 100]" or "(0, 100]"
};

/// A parsed TOML document and the mistakes noted in it so far.
struct Section::Document {
  Document(std::string_view text, const std::string& document_name, std::span<const Override> overrides);

  /// Remembers a mistake once, however often it is noted: laws are made, and complain, once per agent.
  void Note(const toml::source_region& place, const std::string& path, const std::string& message);
  /// Likewise, where the text has its place already; listed as if at `place`.
  void NoteText(const toml::source_region& place, const std::string& text);
  void ThrowIfWrong() const;

  std::string name;  ///< as the user typed it
  toml::table root;
  std::shared_ptr<Table> top;  ///< what was asked of the root

 private:
  struct Mistake {
    bool overridden = false;  ///< mistakes of the command line come after those of the file
    unsigned line = 0;
    unsigned column = 0;
    std::string text;
    auto operator<=>(const Mistake&) const = default;
  };
  std::set<Mistake> mistakes_;
  bool left_out_ = false;
};

/// One table: where it stands, and what has been asked of it. Shared by all copies of its Section.
struct Section::Table {
  /// A value or list, already as TOML text, or the tables of a Child or of Children.
  struct Entry {
    std::string key;
    std::string value;
    std::vector<std::shared_ptr<Table>> tables;
    bool is_list = false;
  };

  std::string path;                   ///< as in messages: "agents.override[0]"; "" for the root
  const toml::table* toml = nullptr;  ///< null if the file has no such table
  toml::source_region place;          ///< of the table, or of the nearest one around it that exists
  bool inherited = false;             ///< stands in the base of the table around it, whose reader complains
  bool broken = false;                ///< something else stands where the table should: no complaints about its keys
  Document* document = nullptr;
  std::shared_ptr<Table> base;               ///< where keys are looked for that this table lacks
  std::set<std::string, std::less<>> known;  ///< keys that somebody asked for
  std::set<std::string, std::less<>> wrong;  ///< keys with a mistake noted
  std::vector<Entry> entries;                ///< in reading order

  std::string PathOf(std::string_view key) const;
  toml::source_region PlaceOf(std::string_view key) const;
  /// The value of `key`, here or in the base; null if absent.
  const toml::node* Get(std::string_view key) const;
  /// `key` is not here but in the base, whose reader it is that complains.
  bool Inherits(std::string_view key) const;
  /// As Get; from now on `key` is a known key.
  const toml::node* Find(std::string_view key);
  bool Wrong(std::string_view key) const;
  Entry* Recorded(std::string_view key);
  void Record(std::string_view key, std::string value);
  std::shared_ptr<Table> MakeChild(const toml::node* node, const std::string& child_path);
  /// Notes "expected `expected`, got (the node)" at the node, or at the table if `node` is null.
  void Expected(std::string_view key, const std::string& path, const toml::node* node, const std::string& expected);

  /// The value of `key` as `accept` takes it out of its node (nullopt: not what is `expected`).
  template <class T, class Accept>
  T Read(std::string_view key, const std::string& expected, const std::optional<T>& fallback, T legal, Accept accept);
  double Number(std::string_view key, const NumberRange& range, std::optional<double> fallback);
  /// The elements of the list `key`; null if there is none.
  const toml::array* List(std::string_view key, const std::string& expected);
  /// The numbers of a list that goes by `path` in messages: `key` or a row of it.
  std::vector<double> Numbers(std::string_view key, const std::string& path, const toml::array& list,
                              const NumberRange& range);
  /// Likewise three numbers; `node` null: absent.
  Eigen::Vector3d Vector3(std::string_view key, const std::string& path, const toml::node* node,
                          const NumberRange& range);
  /// TOML text of all entries, under [header] if that is not empty.
  std::string Resolved(const std::string& header, bool in_list) const;
  /// As an inline table, if it is small enough for that.
  std::optional<std::string> ResolvedInline() const;
};

/// The whole of a regular file. Throws ConfigError: "PATH: is a directory".
std::string ReadRegularFile(const std::string& path);

/// A node as a Value, and that as TOML text on one line. Dates and times become text.
Value ToValue(const toml::node& node);
std::string ToToml(const Value& value);

/// TOML basic string, quoted and escaped.
std::string QuotedToml(std::string_view text);
/// TOML string; text of several lines keeps them, if it can.
std::string StringToml(std::string_view text);
/// `text` for a one-line message: control characters escaped.
std::string OneLine(std::string_view text);
/// `text`, or its first 60 bytes and "...".
std::string CutShort(std::string_view text);
/// OneLine of CutShort: something the user wrote, in a message.
std::string Printable(std::string_view text);
/// "a, b, c".
template <class Names>
std::string Joined(const Names& names) {
  std::string text;
  for (const auto& name : names) text.append(text.empty() ? "" : ", ").append(name);
  return text;
}

}  // namespace mascot
