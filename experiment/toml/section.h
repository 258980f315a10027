#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/value.h"
#include "experiment/toml/key.h"

namespace mascot {

/// One or more mistakes in an experiment file, each as `file:line:column: key: expected ..., got ...`.
class ConfigError : public std::runtime_error {
 public:
  explicit ConfigError(std::vector<std::string> mistakes);
  const std::vector<std::string>& mistakes() const { return mistakes_; }

 private:
  std::vector<std::string> mistakes_;
};

/// A key given on the command line, which replaces the file's.
struct Override {
  std::string key;          ///< dotted: "law.p_gain"
  std::string value;        ///< a TOML value: "0.5", "[1, 2]", "'ring'"
  std::string origin = {};  ///< what messages say in place of a file and line; empty: "--set key=value"
  bool removes = false;     ///< the key is removed, if it is there; there is no value
};

inline constexpr std::size_t kMaxRegularFile = std::size_t{16} << 20;  // bytes, unless the caller allows more
/// The content of a regular file of at most `max` bytes. Throws ConfigError, e.g. "PATH: is a directory".
std::string ReadRegularFile(const std::string& path, std::size_t max = kMaxRegularFile);

/// One table of a TOML file, read strictly. Each reader checks type and range; a mistake is noted (not thrown) and the
/// fallback or the nearest legal value is returned, so that one pass finds all mistakes. Every value read, defaults
/// included, is remembered: Resolved() writes them out as the file that reproduces the run. Copies share their state.
/// Only section*.cc use toml++.
class Section {
 public:
  /// Parses a file, or text whose name in messages is `name`. `overrides` replace or add keys. Throws ConfigError if it
  /// cannot be opened (a folder, a dangling link, ...), decoded or parsed.
  static Section FromFile(const std::string& path, std::span<const Override> overrides = {});
  static Section FromText(const std::string& text, const std::string& name, std::span<const Override> overrides = {});
  /// As FromText, of text that is in no file: messages say `origin` without line and column.
  static Section FromInlineTable(const std::string& text, const std::string& origin);

  /// True if `key` is present, here or in the base (InheritFrom).
  bool Has(std::string_view key) const;
  /// True if a mistake was noted at `key` ("": anywhere in this table) or inside it. What follows from its value is
  /// then not worth another message.
  bool Wrong(std::string_view key) const;

  /// Adds `rows` that describe keys of this table. The readers below follow them; tables inside this one follow the
  /// rows of their keys.
  void Use(std::span<const Key> rows);

  // Readers. Range and default come from the key's row (Use); std::logic_error if there is none. Overloads with a range
  // or a fallback are for what only the caller can know. A key without any default is required. Numbers are finite; an
  // integer is accepted as a number.
  double Number(std::string_view key, std::optional<double> fallback = {});
  double Number(std::string_view key, double min, double max, std::optional<double> fallback = {});
  /// As Number() from 0 to `max`, but 0 itself is a mistake.
  double Positive(std::string_view key, double max, std::optional<double> fallback = {});
  std::int64_t Integer(std::string_view key);
  std::int64_t Integer(std::string_view key, std::int64_t min, std::int64_t max,
                       std::optional<std::int64_t> fallback = {});
  bool Boolean(std::string_view key, std::optional<bool> fallback = {});
  std::string Text(std::string_view key, std::optional<std::string> fallback = {});
  /// Where the text of `key` begins, for messages about what is in it.
  struct Place {
    std::string file;    ///< the file's name alone
    std::string folder;  ///< the folder of the file, as given; "": the current one
    int line = 1;        ///< line in `file` of the text's first line
  };
  Place PlaceOfText(std::string_view key) const;
  /// The place of `key` ("": of this table) as messages say it: "a.toml:12:7", or where an override comes from.
  std::string Where(std::string_view key) const;
  /// The text of the file that `key` names, relative to this document's folder. Resolved() has the text itself, under
  /// `text_key`.
  struct FileText {
    std::string text;
    std::string name;         ///< the file's, without its folders
    std::string folder = {};  ///< the folder of the file; "": the current one
  };
  FileText TextOfFile(std::string_view key, std::string_view text_key);
  /// The contents of the file that `key` names, relative to this document's folder: at most `max` bytes. Resolved() has
  /// them in base64, under `base64_key`.
  struct FileContents {
    std::string bytes;
    std::string name;  ///< the file's, without its folders
  };
  FileContents ContentsOfFile(std::string_view key, std::string_view base64_key, std::size_t max);
  /// As above, but Resolved() has nothing of them: the caller records what it makes of them. `max` may be any size.
  FileContents ContentsOfFile(std::string_view key, std::size_t max);
  /// The absolute path of the file that `key` names, relative to this document's folder; the file need not exist.
  /// Resolved() has the absolute path. "" after a mistake.
  std::string PathOfFile(std::string_view key);
  /// One of `names`; the message of a mistake lists them and offers the nearest.
  std::string OneOf(std::string_view key);
  std::string OneOf(std::string_view key, std::span<const std::string_view> names,
                    std::optional<std::string> fallback = {});
  std::vector<std::string> Texts(std::string_view key, std::optional<std::vector<std::string>> fallback = {});
  Eigen::Vector3d Vector3(std::string_view key, std::optional<Eigen::Vector3d> fallback = {});
  Eigen::Vector3d Vector3(std::string_view key, double min, double max, std::optional<Eigen::Vector3d> fallback = {});
  /// A list of numbers of any length (empty if absent).
  std::vector<double> Numbers(std::string_view key);
  std::vector<double> Numbers(std::string_view key, double min, double max);
  /// A list of lists of numbers, of any lengths (empty if absent): Laplacians, edges.
  std::vector<std::vector<double>> Rows(std::string_view key);
  std::vector<std::vector<double>> Rows(std::string_view key, double min, double max);
  /// A list of points: lists of exactly three numbers (empty if absent).
  std::vector<Eigen::Vector3d> Points(std::string_view key);
  std::vector<Eigen::Vector3d> Points(std::string_view key, double min, double max);

  /// A list of lists of points, of any lengths (empty if absent).
  std::vector<std::vector<Eigen::Vector3d>> PointLists(std::string_view key);

  /// The kind of the value: "number", "string", "list", "table", ..., or "" if absent.
  std::string Kind(std::string_view key) const;
  /// A table inside this one; an absent one reads as empty.
  Section Child(std::string_view key);
  /// An array of tables ([[key]]); absent reads as none.
  std::vector<Section> Children(std::string_view key);
  /// Table `index` (from 0) of that array alone, which must be there.
  Section Child(std::string_view key, std::size_t index);

  /// From now on, keys that this table lacks are read from `base`, but for `own`. Mistakes in them are left to the
  /// reader of `base`.
  void InheritFrom(const Section& base, std::initializer_list<std::string_view> own = {});
  /// If this table itself has `key`, it does not inherit `others` from now on: they contradict `key`, or belong to what
  /// it replaces. If `key` is given on the command line, the table does not have them either, unless they are, too.
  void Supersede(std::string_view key, std::initializer_list<std::string_view> others) {
    Supersede(key, std::span(others.begin(), others.size()));
  }
  /// Each of these keys, of which a table has one at most, supersedes the others.
  void TakeOneOf(std::initializer_list<std::string_view> keys);
  /// The value of `key`, of any kind; `absent` if there is none.
  Value Free(std::string_view key, const Value& absent = {});

  /// Notes a mistake at the place of `key` (or of this table if absent): message = "expected ..., got ...".
  void Fail(std::string_view key, const std::string& message);
  /// As Fail, at row `row` (from 0) of the list `key`: "graph.laplacian[2]: ...".
  void FailRow(std::string_view key, std::size_t row, const std::string& message);
  /// As Fail, inside the value of `key`, which Free() read: `inner` = "gain" or "limits[2].max".
  void FailInside(std::string_view key, const std::string& inner, const std::string& message);
  /// As Fail, but the mistake is in the text of `key`, at this place: "FILE:LINE:COLUMN: law.python: ...".
  void FailInText(std::string_view key, const std::string& place, const std::string& message);
  /// Notes every key of this table that was never asked for as unknown, with "did you mean".
  void Done();
  /// Throws ConfigError if any section of this document noted a mistake; in order of line and column.
  void ThrowIfWrong() const;
  /// TOML text of everything read so far, in reading order, defaults included, shortest round-trip floats.
  std::string Resolved() const;
  /// What was read of this table so far, defaults included, as Resolved() has it.
  Value::Table AsRead() const;
  /// This table as it stands in the document, without what it inherits.
  Value::Table InTheFile() const;

 private:
  /// The path of the file that `key` names, from this document's folder.
  std::filesystem::path FileOf(std::string_view key);
  /// What `file` holds, which `key` names; notes a mistake if it cannot be read.
  std::string ReadFileOf(std::string_view key, const std::filesystem::path& file, std::size_t max = kMaxRegularFile);
  friend class ValueTables;
  struct Document;
  struct Table;
  Section(std::shared_ptr<Document> document, std::shared_ptr<Table> table);
  void Supersede(std::string_view key, std::span<const std::string_view> others);
  /// The table of the document's root.
  static Section Of(const std::shared_ptr<Document>& document);
  std::shared_ptr<Document> document_;
  std::shared_ptr<Table> table_;
};

/// The name among `names` that is closest to `word`, if it is close enough for a typing mistake.
std::optional<std::string> DidYouMean(std::string_view word, std::span<const std::string_view> names);

/// What is wrong with a thing that is in the file for the second time: "expected each edge once, got [1, 2] again".
std::string EachOnce(std::string_view kind, const std::string& thing, std::string_view once = "once");

/// `value` as TOML on one line.
std::string ToToml(const Value& value);

/// Shortest decimal text that reads back as exactly `value`; always with a point or exponent ("40.0").
std::string ShortestFloat(double value);

}  // namespace mascot
