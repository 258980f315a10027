#include "orchestrator/reference/reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "agent/laws/laws.h"
#include "experiment/experiment.h"
#include "experiment/toml/key.h"
#include "orchestrator/reference/markdown.h"

namespace mascot {
namespace {

constexpr std::string_view kIntroduction =
    R"(# Every key of an experiment file

<!-- Made from the tables in the code by `cmake --build build/release --target reference`; a test keeps it current. -->

An experiment is one TOML file. Every key has a default, except those marked *required*. An unknown key, or a value of
the wrong type or out of range, ends `orchestrator` with exit code 2 before anything starts. The message has file, line
and column, what was expected and what was found. `orchestrator up FILE --set table.key=value` sets a key without
editing the file.

The name of a key ends with its unit; the unit of a gain is beside its range. `[a, b]` includes both ends, `(a, b]`
excludes a. Points and vectors are `[x, y, z]` in the world frame W (x east, y north, z up), unless the key says
otherwise; B is the body frame (x forward, y left, z up). Agent i *hears* agent j if it receives the state of j.

A *live* key may be set by an event (`[[events]]`, [events.md](events.md)) while a run goes on.

Editors with TOML support (VS Code with Even Better TOML, and others based on taplo) complete and check the keys as you
type if the file begins with `#:schema` and the path of [mascot.schema.json](mascot.schema.json), as the files in
`configs/` do.
)";

bool IsIn(std::span<const Key> rows, const Key& key) {
  return std::ranges::any_of(rows, [&](const Key& row) {
    return row.name == key.name && row.meaning == key.meaning && ValueText(row) == ValueText(key) &&
           DefaultText(row) == DefaultText(key);
  });
}

/// "`a`, `b`"
std::string NameList(const std::vector<Key>& keys) {
  std::string names;
  for (const Key& key : keys) names += fmt::format("{}`{}`", names.empty() ? "" : ", ", key.name);
  return names;
}

/// The keys of `rows` that are not in `others`.
std::vector<Key> Without(std::span<const Key> others, std::span<const Key> rows) {
  std::vector<Key> rest;
  std::ranges::copy_if(rows, std::back_inserter(rest), [&](const Key& key) { return !IsIn(others, key); });
  return rest;
}

/// Writes the reference from top to bottom.
class Writer {
 public:
  std::string Write() {
    std::vector<Key> alone;  // keys of no table
    for (const Key& key : ExperimentKeys())
      key.keys.empty() ? alone.push_back(key) : tables_.push_back({std::string(key.name), key.keys});
    text_ += "\n## The file\n" + TableOfKeys(alone);
    for (const Key& table : ExperimentKeys()) {
      if (table.keys.empty()) continue;
      text_ += fmt::format("\n## [{}]\n", table.name);
      if (!table.meaning.empty()) text_ += "\n" + Sentence(table.meaning) + "\n";
      text_ += TableOfKeys(table.keys);
      if (table.name == "graph") WriteTopologies();
      WriteInner(std::string(table.name), table.keys);
    }
    WriteLaws();
    return std::string(kIntroduction) + text_;
  }

 private:
  /// Writes the tables inside a table. Tables with the same keys are written once.
  void WriteInner(const std::string& path, std::span<const Key> rows) {
    for (const Key& table : rows) {
      const auto is_same = [&](std::span<const Key> keys) { return keys.data() == table.keys.data(); };
      if (table.keys.empty() || std::ranges::any_of(tables_, is_same, &Table::rows)) continue;
      const std::string inner = fmt::format("{}.{}", path, table.name);
      const bool is_list = table.kind == ValueKind::kTables;
      text_ += fmt::format("\n### {}{}{}\n\n{}\n", is_list ? "[[" : "[", inner, is_list ? "]]" : "]",
                           Introduction(table, rows));
      WriteKeys(table.keys);
      if (table.keys.data() == FaultKeys().data()) WriteFaults();
      tables_.push_back({inner, table.keys});
      WriteInner(inner, table.keys);
    }
  }

  static std::string Introduction(const Key& table, std::span<const Key> rows) {
    std::vector<Key> alike;
    std::ranges::copy_if(rows, std::back_inserter(alike),
                         [&](const Key& row) { return row.keys.data() == table.keys.data(); });
    return alike.size() == 1 ? Sentence(table.meaning) : "The keys of " + NameList(alike) + ".";
  }

  /// Writes a table of keys; if another table has at least half of them too, only the differences.
  void WriteKeys(std::span<const Key> rows) {
    for (const Table& other : tables_) {
      const std::vector<Key> own = Without(other.rows, rows);
      if (2 * own.size() > rows.size()) continue;
      const std::vector<Key> left_out = Without(rows, other.rows);
      if (!own.empty()) text_ += TableOfKeys(own);
      text_ += fmt::format("\n{} as in `[{}]`{}.\n", own.empty() ? "Keys" : "Also keys", other.path,
                           left_out.empty() ? "" : ", but for " + NameList(left_out));
      return;
    }
    text_ += TableOfKeys(rows);
  }

  void WriteTopologies() {
    text_ += "\n| topology | which agent hears which |\n|---|---|\n";
    for (const Topology& family : Topologies()) text_ += fmt::format("| `{}` | {} |\n", family.name, family.meaning);
  }

  void WriteFaults() {
    text_ +=
        "\nWhat happens, and the keys that go with it ([faults.md](faults.md)):\n\n| `of` | `kind` | keys | what "
        "happens |\n"
        "|---|---|---|---|\n";
    for (const FaultRow& row : FaultRows()) {
      std::string keys(row.parameters);
      for (std::size_t at = 0; (at = keys.find(", ", at)) != std::string::npos; at += 4) keys.replace(at, 2, "`, `");
      text_ += fmt::format("| `{}` | `{}` | {} | {} |\n", kFaultParts.Name(row.of), kFaultKinds.Name(row.kind),
                           keys.empty() ? "" : "`" + keys + "`", row.meaning);
    }
  }

  void WriteLaws() {
    text_ +=
        "\n## Parameters of the laws\n\nFurther keys of `[law]`, by its `name`. Sources and what theory says: "
        "`orchestrator laws`, [laws.md](laws.md).\n";
    for (const LawEntry& law : Laws()) {
      text_ += fmt::format("\n### law.name = \"{}\"\n\n{} Default of `axes`: `\"{}\"`.\n\n```\n{}\n```\n", law.name,
                           Sentence(law.summary), kAxes.Name(law.axes), law.equation);
      text_ += TableOfKeys(law.parameters);
    }
  }

  struct Table {
    std::string path;
    std::span<const Key> rows;
  };
  std::vector<Table> tables_;  // top-level tables, and the inner tables written so far
  std::string text_;
};

}  // namespace

std::string ConfigurationReference() { return Writer().Write(); }

}  // namespace mascot
