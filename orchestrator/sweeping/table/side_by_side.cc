#include "orchestrator/sweeping/table/side_by_side.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "base/utf8.h"
#include "experiment/toml/section.h"
#include "orchestrator/formats/outside_json.h"
#include "orchestrator/report/json.h"
#include "orchestrator/sweeping/plan/labels.h"
#include "orchestrator/sweeping/plan/values.h"
#include "orchestrator/sweeping/table/metrics.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kWidest = 32;  // characters of a cell in the text

using Cells = std::map<std::string, std::string>;

/// The values of a table by dotted keys, as TOML.
void Flatten(const Value::Table& table, const std::string& prefix, Cells& cells) {
  for (const auto& [key, value] : table) {
    const auto* inner = std::get_if<Value::Table>(&value.data);
    if (inner != nullptr && !inner->empty())
      Flatten(*inner, prefix + key + ".", cells);
    else
      cells[prefix + key] = ToToml(value);
  }
}

std::string FileOf(const std::string& run, const char* name) {
  const fs::path path = fs::path(run) / name;
  if (!fs::is_regular_file(path)) throw ConfigError({run + ": expected the folder of a finished run, got no " + name});
  return path.string();
}

/// The keys of a run's experiment, and the same in plain text, in which equal values are equal.
struct Config {
  Cells cells, plain;
};

Config ConfigOf(const std::string& run) {
  const Value::Table keys = Section::FromFile(FileOf(run, "config.toml")).InTheFile();
  Config config{.cells = {}, .plain = PlainKeys(keys)};
  Flatten(keys, "", config.cells);
  return config;
}

/// Names of the laws whose figures a summary has.
std::vector<std::string> LawsIn(const nlohmann::json& summary) {
  std::vector<std::string> laws;
  if (summary.contains("laws") && summary["laws"].is_object())
    for (const auto& [law, figures] : summary["laws"].items()) laws.push_back(law);
  return laws;
}

Cells SummaryOf(const std::string& run, const std::string& text) try {
  const auto json = ReadJson<nlohmann::json>(text);
  Cells cells = SweepMetrics(text, SweepMetricNames(LawsIn(json)));
  if (json.contains("exit")) cells["exit"] = json["exit"].dump();
  return cells;
} catch (const nlohmann::json::exception& error) {
  throw ConfigError({run + "/summary.json: " + error.what()});
} catch (const JsonError& error) {
  throw ConfigError({run + "/summary.json: expected JSON, got " + error.what()});
}

/// The keys of all runs, `first` ones first, then in alphabetical order.
std::vector<std::string> KeysOf(const std::vector<Cells>& runs, const std::vector<std::string>& first) {
  std::vector<std::string> keys = first;
  std::set<std::string> others;
  for (const Cells& cells : runs)
    for (const auto& [key, cell] : cells)
      if (std::ranges::find(first, key) == first.end()) others.insert(key);
  keys.insert(keys.end(), others.begin(), others.end());
  return keys;
}

/// Names of the runs at the heads of columns: their paths, without the folders that they share.
std::vector<std::string> HeadsOf(const std::vector<std::string>& runs) {
  std::vector<std::vector<fs::path>> paths;
  for (const std::string& run : runs) {
    const fs::path path = fs::path(run).lexically_normal();
    paths.emplace_back(path.begin(), path.end());
    if (paths.back().size() > 1 && paths.back().back().empty()) paths.back().pop_back();  // it ended with a slash
  }
  std::size_t shared = paths.front().size() - 1;
  for (const auto& path : paths) {
    const auto differs = std::ranges::mismatch(path, paths.front()).in1;
    shared = std::min({shared, path.size() - 1, static_cast<std::size_t>(differs - path.begin())});
  }
  std::vector<std::string> heads;
  for (const auto& path : paths) {
    fs::path head;
    for (std::size_t k = shared; k < path.size(); ++k) head /= path[k];
    heads.push_back(head.string());
  }
  return heads;
}

/// A cell as the text shows it.
std::string Shown(const std::string& cell) {
  if (cell.empty()) return "-";
  const auto json = JsonOrNull<nlohmann::json>(cell);
  if (json.is_number_float()) return fmt::format("{:.6g}", json.get<double>());
  return cell.size() <= kWidest ? cell : std::string(CutUtf8(cell, kWidest - 3)) + "...";
}

/// The number of characters of UTF-8 text.
std::size_t WidthOf(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return (c & 0xc0) != 0x80; }));
}

/// Lines of a table whose columns, but the first, are flush right.
std::string Aligned(const std::vector<std::vector<std::string>>& lines) {
  std::vector<std::size_t> widths;
  for (const auto& line : lines)
    for (std::size_t k = 0; k < line.size(); ++k) {
      if (k == widths.size()) widths.push_back(0);
      widths[k] = std::max(widths[k], WidthOf(line[k]));
    }
  std::string text;
  for (const auto& line : lines) {
    for (std::size_t k = 0; k < line.size(); ++k)
      text += k == 0 ? fmt::format("{:<{}}", line[k], widths[k]) : fmt::format("  {:>{}}", line[k], widths[k]);
    text.erase(text.find_last_not_of(' ') + 1);
    text += "\n";
  }
  return text;
}

}  // namespace

SideBySide::SideBySide(const std::vector<std::string>& runs) : runs_(runs) {
  std::vector<Cells> configs, plain, summaries;
  std::set<std::string> laws;
  for (const std::string& run : runs) {
    const std::string text = ReadRegularFile(FileOf(run, "summary.json"));
    Config config = ConfigOf(run);
    configs.push_back(std::move(config.cells));
    plain.push_back(std::move(config.plain));
    summaries.push_back(SummaryOf(run, text));
    for (const std::string& law : LawsIn(ReadJson<nlohmann::json>(text))) laws.insert(law);
  }
  const auto line_of = [](const std::string& key, std::vector<Cells>& all) {
    Line line{key, {}};
    for (Cells& cells : all) line.cells.push_back(cells[key]);
    return line;
  };
  for (const std::string& key : KeysOf(configs, {})) {
    const std::vector<std::string> values = line_of(key, plain).cells;
    if (std::ranges::adjacent_find(values, std::not_equal_to<>()) != values.end())
      config_.push_back(line_of(key, configs));
  }
  std::vector<std::string> first{"exit"};
  for (const std::string& name : SweepMetricNames({laws.begin(), laws.end()})) first.push_back(name);
  for (const std::string& key : KeysOf(summaries, first)) {
    Line line = line_of(key, summaries);
    if (std::ranges::any_of(line.cells, [](const std::string& cell) { return !cell.empty(); }))
      summary_.push_back(line);
  }
}

std::string SideBySide::Text() const {
  std::vector<std::vector<std::string>> lines{{""}};
  for (const std::string& head : HeadsOf(runs_)) lines.front().push_back(head);
  const auto add = [&](const std::string& name, const Line& line) {
    lines.push_back({"  " + name});
    for (const std::string& cell : line.cells) lines.back().push_back(Shown(cell));
  };
  lines.push_back({config_.empty() ? "the same experiment" : "set differently"});
  for (const Line& line : config_) add(line.name, line);
  lines.push_back({"measured and predicted"});
  for (const Line& line : summary_) add(LabelOfColumn(line.name), line);
  return Aligned(lines);
}

std::string SideBySide::JsonText() const {
  const auto value_of = [](const std::string& cell) {
    if (cell.empty()) return Json(nullptr);
    const auto value = JsonOrNull<Json>(cell);
    return value.is_null() ? Json(cell) : value;  // TOML that is no JSON
  };
  Json json{{"runs", runs_}, {"config", Json::object()}, {"summary", Json::object()}};
  for (const Line& line : config_)
    for (const std::string& cell : line.cells) json["config"][line.name].push_back(value_of(cell));
  for (const Line& line : summary_)
    for (const std::string& cell : line.cells) json["summary"][line.name].push_back(value_of(cell));
  return mascot::JsonText(json);
}

}  // namespace mascot
