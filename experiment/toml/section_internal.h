#pragma once

// What the files section*.cc share; no other file here includes this, or toml++.

#include <toml++/toml.h>

#include <optional>
#include <set>
#include <variant>

#include "base/utf8.h"
#include "experiment/toml/section.h"

namespace mascot {

/// A parsed TOML document and the mistakes noted in it so far.
struct Section::Document {
  Document(std::string_view text, const std::string& document_name, std::span<const Override> overrides);
  /// A document that is in no file: messages say `origin` in place of file, line and column.
  explicit Document(std::string origin);

  /// Stores a mistake; noted again, it counts once (laws are made once per agent, and each may note it).
  void Note(const toml::source_region& place, const std::string& path, const std::string& message);
  /// Notes that the table has no key `key`. If other tables have one, the message will name it, unless this one is in a
  /// list, where keys mean less than elsewhere.
  void NoteUnknown(const toml::source_region& place, const std::string& path, const std::string& key);
  /// As Note(), for a `text` that names its place already; listed as if at `place`.
  void NoteText(const toml::source_region& place, const std::string& text);
  void ThrowIfWrong() const;
  /// A place as messages say it.
  std::string PlaceText(const toml::source_region& place) const;
  /// What messages say in place of file, line and column; nullopt: `place` is in the file.
  std::optional<std::string> OriginOf(const toml::source_region& place) const;

  std::string name;         ///< as the user typed it
  std::string origin;       ///< of what is in no file; empty: it is in a file
  bool is_recorded = true;  ///< what is read is remembered, for Resolved()
  toml::table root;
  std::shared_ptr<Table> top;  ///< the table of the root

 private:
  struct Mistake {
    bool overridden = false;  ///< mistakes of the command line come after those of the file
    unsigned line = 0;
    unsigned column = 0;
    std::string text;
    std::string unknown = {};  ///< a key that its table does not have
    auto operator<=>(const Mistake&) const = default;
  };
  void Add(const toml::source_region& place, Mistake mistake);

  std::set<Mistake> mistakes_;
  std::optional<std::string> left_out_;  // place of the first mistake that is
};

/// One table: where it stands, and what was read from it. Shared by all copies of its Section.
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
  toml::source_region place;          ///< place of the table, or of the nearest one around it that exists
  bool inherited = false;             ///< stands in the base of the table around it; the base's reader notes mistakes
  bool broken = false;  ///< another kind of value stands in its place: no mistakes are noted about its keys
  Document* document = nullptr;
  const Table* base = nullptr;                    ///< gives the keys that this table lacks; of the same document
  std::set<std::string, std::less<>> superseded;  ///< keys that the base does not give
  std::set<std::string, std::less<>> left_out;    ///< keys of the file in whose place the command line gives others
  std::set<std::string, std::less<>> known;       ///< keys that were asked for
  std::set<std::string, std::less<>> wrong;       ///< keys with a mistake noted
  std::vector<Entry> entries;                     ///< in reading order
  std::vector<std::span<const Key>> rows;         ///< rows that describe the keys of this table

  /// The row of `key`, or null.
  const Key* Row(std::string_view key) const;
  /// The row of `key`. Throws std::logic_error if there is none.
  const Key& RowOf(std::string_view key) const;
  /// The default in the row of `key`, converted by `accept`; nullopt: there is none.
  template <class T, class Accept>
  std::optional<T> RowDefault(std::string_view key, Accept accept) const;
  std::string PathOf(std::string_view key) const;
  toml::source_region PlaceOf(std::string_view key) const;
  /// True if the table has `key` itself, not from the base.
  bool Has(std::string_view key) const { return toml != nullptr && toml->contains(key) && !left_out.contains(key); }
  /// The value of `key`, here or in the base; null if absent.
  const toml::node* Get(std::string_view key) const;
  /// True if `key` is not here but in the base, whose reader notes its mistakes.
  bool Inherits(std::string_view key) const;
  /// As Get(); from now on `key` is a known key.
  const toml::node* Find(std::string_view key);
  bool Wrong(std::string_view key) const;
  /// The paths of the keys of this name that were asked for of this table and of those within it, but for those of
  /// lists.
  std::vector<std::string> PathsWith(std::string_view key) const;
  /// The entry of `key`, or null.
  Entry* Recorded(std::string_view key);
  /// Stores `value` as the entry of `key`.
  void Record(std::string_view key, std::string value);
  /// A Table for `node`, which is the value of `key` or in its list; null: absent.
  std::shared_ptr<Table> MakeChild(std::string_view key, const toml::node* node, const std::string& child_path);
  /// Notes "expected `expected`, got ..." at the node, or at the table if `node` is null.
  void Expected(std::string_view key, const std::string& path, const toml::node* node, const std::string& expected);

  /// Reads `key`: `accept` converts its node, or returns nullopt if that is not what is `expected`. Without a legal
  /// value: the fallback, the default of the row, or `legal`.
  template <class T, class Accept>
  T Read(std::string_view key, const std::string& expected, const std::optional<T>& fallback, T legal, Accept accept);
  double Number(std::string_view key, const Range& range, std::optional<double> fallback);
  /// The list `key`; null if there is none.
  const toml::array* List(std::string_view key, const std::string& expected);
  // Readers of lists: the value of `key`, or its default.
  std::vector<std::string> Texts(std::string_view key, std::optional<std::vector<std::string>> fallback);
  Eigen::Vector3d Vector3(std::string_view key, const Range& range, const std::optional<Eigen::Vector3d>& fallback);
  std::vector<double> Numbers(std::string_view key, const Range& range);
  std::vector<std::vector<double>> Lists(std::string_view key, const Range& range);
  std::vector<Eigen::Vector3d> Points(std::string_view key, const Range& range);
  std::vector<std::vector<Eigen::Vector3d>> PointLists(std::string_view key, const Range& range);
  /// The points in `list`, whose name in messages is `path`: the value of `key` or a row of it. Appends their text.
  std::vector<Eigen::Vector3d> Points(std::string_view key, const std::string& path, const toml::array& list,
                                      const Range& range, std::vector<std::string>& texts);
  /// The numbers in `list`, whose name in messages is `path`: the value of `key` or a row of it.
  std::vector<double> Numbers(std::string_view key, const std::string& path, const toml::array& list,
                              const Range& range);
  /// The three numbers in `node` (null: absent), whose name in messages is `path`.
  Eigen::Vector3d Vector3(std::string_view key, const std::string& path, const toml::node* node, const Range& range);
  /// TOML text of all entries, under [header] if that is not empty.
  std::string Resolved(const std::string& header, bool in_list) const;
  /// TOML text as an inline table; nullopt if that would be too long.
  std::optional<std::string> ResolvedInline() const;
};

/// Largest number of parts of a dotted key, and of levels of a value: lists and tables in each other.
constexpr std::size_t kDeepestKey = 32, kDeepestValue = 64;
/// True for characters of keys that need no quotes.
bool IsBare(char c);
/// Throws ConfigError with the place in `name`.
toml::table ParseToml(std::string_view text, const std::string& name);
/// One step of a dotted key: a key of a table, or an index in a list.
using Step = std::variant<std::string, std::size_t>;
/// "agents.override[0].start_s" as its steps; empty if it is not of that form.
std::vector<Step> Steps(std::string_view key);
/// "expected a dotted key ...", of a key without steps.
std::string ExpectedKey(std::string_view key);
/// Where the steps lead; null: nothing is there.
toml::node* Find(toml::table& root, std::span<const Step> steps);
/// Puts a value where the steps lead, and makes the tables that the document lacks. `extends`: and the tables of lists:
/// an index one beyond the end of a list of tables adds a table, and a list if need be. Throws std::invalid_argument if
/// the steps do not fit.
void Put(toml::table& root, std::span<const Step> steps, toml::node&& value, bool extends);
/// Takes out what is where the steps lead; of a list only its last element. Nothing is done if they lead nowhere.
void Remove(toml::table& root, std::span<const Step> steps);
/// Where messages say that an override comes from: "--set law.p_gain=0.5".
std::string OriginOf(const Override& override);
/// Replaces or adds a key of the document. Throws ConfigError.
void Apply(const Override& override, toml::table& root);

/// "number", "string", "list", ...
std::string KindOf(const toml::node& node);
/// What the user wrote, for "got ...".
std::string Got(const toml::node& node);
/// The number in `node` if it is one that `range` holds and a double holds exactly.
std::optional<double> NumberIn(const toml::node& node, const Range& range);
std::optional<std::string> TextIn(const toml::node& node);
/// "graph.edges[2]"
std::string Indexed(std::string_view path, std::size_t index);

/// A node as a Value. Dates and times become text.
Value ToValue(const toml::node& node);
/// The inverse, but for dates and times.
toml::table ToTable(const Value::Table& table);
/// TOML basic string, quoted and escaped.
std::string QuotedToml(std::string_view text);
/// TOML string; a multi-line one for text of several lines, if possible.
std::string StringToml(std::string_view text);
/// Whether any character of ASCII in `text` is a control.
bool HasControls(std::string_view text);
/// `text`, or its first 60 bytes and "...".
std::string CutShort(std::string_view text);
/// PlainLine() of CutShort(): text of the user, for a message.
std::string Printable(std::string_view text);
/// "a, b, c".
template <class Names>
std::string Joined(const Names& names) {
  std::string text;
  for (const auto& name : names) text.append(text.empty() ? "" : ", ").append(name);
  return text;
}

template <class T, class Accept>
std::optional<T> Section::Table::RowDefault(std::string_view key, Accept accept) const {
  const Key* row = Row(key);
  if (row == nullptr || row->fallback.empty()) return std::nullopt;
  const toml::table table = toml::parse("value = " + std::string(row->fallback));
  const std::optional<T> value = accept(*table.get("value"));
  if (!value && row->or_kind == ValueKind::kNone)
    throw std::logic_error("the row of the key " + PathOf(key) + " has an impossible default");
  return value;
}

template <class T, class Accept>
T Section::Table::Read(std::string_view key, const std::string& expected, const std::optional<T>& fallback, T legal,
                       Accept accept) {
  const toml::node* node = Find(key);
  if (node != nullptr)
    if (std::optional<T> value = accept(*node)) return *value;
  const std::optional<T> otherwise = fallback ? fallback : RowDefault<T>(key, accept);
  if (node == nullptr && otherwise) return *otherwise;
  Expected(key, PathOf(key), node, expected);
  return otherwise.value_or(legal);
}

}  // namespace mascot
