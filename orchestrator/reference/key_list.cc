#include "orchestrator/reference/key_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "agent/laws/laws.h"
#include "experiment/read_experiment.h"

namespace mascot {
namespace {

bool IsTable(const Key& key) { return key.kind == ValueKind::kTable || key.kind == ValueKind::kTables; }

void AddKeys(const std::string& path, std::span<const Key> rows, std::vector<ListedKey>& keys) {
  for (const Key& row : rows) {
    const std::string name = path.empty() ? std::string(row.name) : path + "." + std::string(row.name);
    if (!IsTable(row) || row.or_kind != ValueKind::kNone) keys.push_back({.name = name, .row = row, .laws = {}});
    AddKeys(name, row.keys, keys);
  }
}

void AddParameter(const LawEntry& law, const Key& row, std::vector<ListedKey>& keys) {
  const std::string name = "law." + std::string(row.name);
  const auto is_same = [&](const ListedKey& other) {
    return !other.laws.empty() && other.name == name && other.row.meaning == row.meaning &&
           other.row.fallback == row.fallback && ValueText(other.row) == ValueText(row);
  };
  const auto same = std::ranges::find_if(keys, is_same);
  if (same == keys.end())
    keys.push_back({.name = name, .row = row, .laws = {law.name}});
  else
    same->laws.push_back(law.name);
}

/// A key that the example leaves out, as a comment.
std::string Comment(const Key& row) {
  const std::string value = row.fallback.empty() ? "..." : std::string(row.fallback);
  std::string text = fmt::format("# {} = {}", row.name, value);
  text += fmt::format("{:{}}# {} ({})", "", text.size() < 40 ? 40 - text.size() : 1, row.meaning, ValueText(row));
  return text + "\n";
}

/// Whether a line of a file gives this key a value, or begins a table of its name inside [law].
bool Gives(std::string_view line, std::string_view key) {
  if (line.starts_with("[law." + std::string(key) + "]") || line.starts_with("[[law." + std::string(key) + "]]"))
    return true;
  if (!line.starts_with(key)) return false;
  const std::size_t next = line.find_first_not_of(' ', key.size());
  return next != line.npos && (line[next] == '=' || line[next] == '.');
}

}  // namespace

std::vector<ListedKey> AllKeys() {
  std::vector<ListedKey> keys;
  AddKeys("", ExperimentKeys(), keys);
  for (const LawEntry& law : Laws())
    for (const Key& row : law.parameters) AddParameter(law, row, keys);
  return keys;
}

std::string NewExperiment(std::string_view law, const std::string& example) {
  std::vector<std::string> lines;
  std::istringstream text(example);
  for (std::string line; std::getline(text, line);)
    if (!line.starts_with("#:schema")) lines.push_back(line);  // of the folder of the example
  const auto table = std::ranges::find(lines, "[law]");
  if (table == lines.end()) throw std::runtime_error("the example of the law has no table [law]");
  const auto next = std::find_if(table + 1, lines.end(), [](const std::string& line) { return line.starts_with('['); });
  auto last = next;  // of the table: blank lines and the comment of the next table stay where they are
  while (last > table + 1 && ((last - 1)->empty() || (last - 1)->starts_with('#'))) --last;
  std::string comments;
  for (const Key& row : LawTable().Parameters(law))
    if (std::ranges::none_of(lines, [&](const std::string& line) { return Gives(line, row.name); }))
      comments += Comment(row);
  std::string out;
  for (auto line = lines.begin(); line != lines.end(); ++line) {
    if (line == last) out += comments;
    out += *line + "\n";
  }
  return last == lines.end() ? out + comments : out;
}

}  // namespace mascot
