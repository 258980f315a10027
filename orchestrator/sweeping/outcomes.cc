#include "orchestrator/sweeping/outcomes.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include "experiment/toml/section.h"
#include "orchestrator/sweeping/statistics.h"
#include "orchestrator/sweeping/table.h"

namespace mascot {
namespace {

constexpr const char* kSettled = "consensus.settling_time_s";
constexpr std::size_t kReasons = 3;         // printed, of those why runs failed
constexpr std::size_t kReasonLength = 200;  // of the characters printed of each

std::optional<double> NumberIn(const std::string& cell) {
  if (cell == "true" || cell == "false") return cell == "true" ? 1 : 0;
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return error == std::errc() && end == cell.data() + cell.size() ? std::optional(value) : std::nullopt;
}

std::string CellOf(const std::optional<double>& value) {
  if (!value) return "";
  return std::isinf(*value) ? "inf" : ShortestFloat(*value);
}

/// A long text without its middle: a traceback ends with what went wrong.
std::string Shortened(const std::string& text) {
  if (text.size() <= kReasonLength) return text;
  return text.substr(0, kReasonLength / 2) + " ... " + text.substr(text.size() - kReasonLength / 2);
}

/// The law whose figure a column has; empty: a column of all laws.
std::string_view LawOfColumn(std::string_view column) {
  constexpr std::string_view kLaws = "laws.";
  if (!column.starts_with(kLaws)) return {};
  column.remove_prefix(kLaws.size());
  return column.substr(0, column.find('.'));
}

}  // namespace

bool IsTimeOfEvent(std::string_view column) {
  return column.ends_with("_time_s") && column.find(".predicted.") == column.npos &&
         column.find(".deviation.") == column.npos;
}

Outcomes::Outcomes(const SweepPlan& plan, const SweepLaws& laws, Cells columns, std::vector<Cells> rows)
    : plan_(plan), laws_(laws), columns_(std::move(columns)), rows_(std::move(rows)), error_(PlaceOf(kErrorColumn)) {
  const std::size_t settled = PlaceOf(kSettled);
  for (std::size_t run = 0; run < rows_.size(); ++run)
    if (const RunLaws* of_run = laws_.Of(run); of_run != nullptr && !rows_[run][settled].empty())
      settled_.insert(of_run->team);
}

bool Outcomes::MaySettle(std::size_t run) const {
  const RunLaws* laws = laws_.Of(run);
  return laws == nullptr || laws->team_agrees || settled_.contains(laws->team);
}

bool Outcomes::CanHave(std::size_t run, std::string_view metric) const {
  if (metric == kSettled) return MaySettle(run);
  const std::string_view law = LawOfColumn(metric);
  return law.empty() || laws_.Has(run, law);
}

std::size_t Outcomes::PlaceOf(std::string_view column) const {
  return static_cast<std::size_t>(std::ranges::find(columns_, column) - columns_.begin());
}

std::vector<std::string> Outcomes::Lines() const {
  struct Reason {
    std::string text, first_run;
    std::size_t runs = 0;
  };
  std::vector<Reason> reasons;
  std::size_t failed = 0, late = 0, may_settle = 0;
  std::string first_late;
  const std::size_t settled = PlaceOf(kSettled);
  for (std::size_t run = 0; run < rows_.size(); ++run) {
    const Cells& row = rows_[run];
    may_settle += MaySettle(run);
    if (!HasFailed(row)) {
      if (row[settled].empty() && MaySettle(run) && late++ == 0) first_late = row[0];
      continue;
    }
    ++failed;
    auto reason = std::ranges::find(reasons, row[error_], &Reason::text);
    if (reason == reasons.end()) reason = reasons.insert(reason, {row[error_], row[0]});
    ++reason->runs;
  }
  std::vector<std::string> lines;
  if (failed > 0) lines.push_back(fmt::format("failed: {} of {} runs", failed, rows_.size()));
  for (const Reason& reason : std::span(reasons).first(std::min(reasons.size(), kReasons)))
    lines.push_back(fmt::format("  run {}{}: {}", reason.first_run,
                                reason.runs > 1 ? fmt::format(" and {} more", reason.runs - 1) : "",
                                Shortened(reason.text)));
  if (reasons.size() > kReasons) lines.push_back(fmt::format("  and {} other reasons", reasons.size() - kReasons));
  if (late > 0)
    lines.push_back(fmt::format("not settled by the end: {} of {} runs{} (no {}), first run {}", late, may_settle,
                                may_settle < rows_.size() ? " whose law makes agents agree" : "", kSettled,
                                first_late));
  return lines;
}

std::string Outcomes::StatisticsCsv(const std::vector<std::string>& metrics) const {
  std::vector<std::size_t> keys;
  Cells header;
  for (std::size_t k = 0; k < plan_.keys().size(); ++k)
    if (plan_.keys()[k] != kSeedKey) {
      keys.push_back(1 + k);  // behind the number of the run
      header.push_back(plan_.keys()[k]);
    }
  std::vector<Cells> points;  // in order of their first runs
  std::map<Cells, std::vector<std::size_t>> groups;
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    Cells point;
    for (const std::size_t key : keys) point.push_back(rows_[row][key]);
    if (!groups.contains(point)) points.push_back(point);
    groups[point].push_back(row);
  }
  for (const char* name : {"metric", "runs", "failed", "without_value", "mean", "mean_low_95", "mean_high_95", "median",
                           "decile_1", "decile_9"})
    header.emplace_back(name);
  std::string csv = CsvLine(header);
  for (const std::string& metric : metrics) {
    const std::size_t place = PlaceOf(metric);
    if (std::ranges::none_of(rows_, [&](const Cells& row) { return NumberIn(row[place]).has_value(); })) continue;
    for (const Cells& point : points) AddStatistics(metric, groups[point], csv);
  }
  return csv;
}

/// Appends the line of a metric over the runs of a group, which differ in their seeds alone.
void Outcomes::AddStatistics(const std::string& metric, const std::vector<std::size_t>& group, std::string& csv) const {
  const Cells& first = rows_[group.front()];
  if (!CanHave(group.front(), metric)) return;
  const std::size_t place = PlaceOf(metric);
  ValueSample sample;
  std::size_t failed = 0;
  for (const std::size_t row : group) {
    if (const auto value = NumberIn(rows_[row][place])) sample.values.push_back(*value);
    failed += HasFailed(rows_[row]);
  }
  const std::size_t without = group.size() - failed - sample.values.size();
  if (IsTimeOfEvent(metric)) sample.beyond = without;
  const Spread spread = SpreadOf(sample);
  const bool bounded = spread.mean && spread.half_width;
  Cells line;
  for (std::size_t k = 0; k < plan_.keys().size(); ++k)
    if (plan_.keys()[k] != kSeedKey) line.push_back(first[1 + k]);
  line.push_back(metric);
  for (const std::size_t count : {group.size(), failed, without}) line.push_back(std::to_string(count));
  line.push_back(CellOf(spread.mean));
  line.push_back(bounded ? CellOf(*spread.mean - *spread.half_width) : "");
  line.push_back(bounded ? CellOf(*spread.mean + *spread.half_width) : "");
  for (const auto& value : {spread.median, spread.decile_1, spread.decile_9}) line.push_back(CellOf(value));
  csv += CsvLine(line);
}

}  // namespace mascot
