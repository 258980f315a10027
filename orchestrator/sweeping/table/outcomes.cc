#include "orchestrator/sweeping/table/outcomes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "base/number.h"
#include "experiment/toml/section.h"
#include "orchestrator/sweeping/table/statistics.h"
#include "orchestrator/sweeping/table/table.h"

namespace mascot {
namespace {

constexpr const char* kSettled = "consensus.settling_time_s";
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kReasons = 3;         // printed, of those why runs failed
constexpr std::size_t kReasonLength = 200;  // of the characters printed of each

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

std::optional<double> NumberInCell(const std::string& cell) {
  if (cell == "true" || cell == "false") return cell == "true" ? 1 : 0;
  return NumberFrom<double>(cell);
}

Outcomes::Outcomes(const SweepPlan& plan, const SweepLaws& laws, Cells columns)
    : plan_(plan),
      laws_(laws),
      columns_(std::move(columns)),
      error_(static_cast<std::size_t>(std::ranges::find(columns_, kErrorColumn) - columns_.begin())),
      values_(columns_.size() - error_ - 1) {}

void Outcomes::Add(const Cells& row) {
  const std::size_t run = has_failed_.size();
  has_failed_.push_back(!row[error_].empty());
  if (has_failed_.back()) AddFailure(row[error_]);
  for (std::size_t k = 0; k < values_.size(); ++k) {
    const auto value = NumberInCell(row[error_ + 1 + k]);
    if (value && values_[k].empty()) values_[k].assign(run, kNone);
    if (value || !values_[k].empty()) values_[k].push_back(value.value_or(kNone));
    if (value && columns_[error_ + 1 + k] == kSettled)
      if (const RunLaws* laws = laws_.Of(run)) settled_.insert(laws->team);
  }
}

void Outcomes::AddFailure(const std::string& why) {
  const auto [place, is_new] = place_of_reason_.emplace(why, reasons_.size());
  if (is_new) reasons_.push_back({.text = reasons_.size() < kReasons ? why : "", .first_run = has_failed_.size() - 1});
  ++reasons_[place->second].runs;
}

const std::vector<double>& Outcomes::ValuesOf(std::string_view column) const {
  const auto place = std::find(columns_.begin() + static_cast<std::ptrdiff_t>(error_) + 1, columns_.end(), column);
  assert(place != columns_.end());
  return values_[static_cast<std::size_t>(place - columns_.begin()) - error_ - 1];
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

std::vector<std::string> Outcomes::Lines() const {
  const std::size_t runs = has_failed_.size();
  const std::vector<double>& settled = ValuesOf(kSettled);
  std::size_t failed = 0, late = 0, may_settle = 0, first_late = 0;
  for (std::size_t run = 0; run < runs; ++run) {
    failed += has_failed_[run];
    if (!MaySettle(run)) continue;
    ++may_settle;
    if (!has_failed_[run] && (settled.empty() || std::isnan(settled[run])) && late++ == 0) first_late = run;
  }
  std::vector<std::string> lines;
  if (failed > 0) lines.push_back(fmt::format("failed: {} of {} runs", failed, runs));
  for (const Reason& reason : std::span(reasons_).first(std::min(reasons_.size(), kReasons)))
    lines.push_back(fmt::format("  run {}{}: {}", reason.first_run,
                                reason.runs > 1 ? fmt::format(" and {} more", reason.runs - 1) : "",
                                Shortened(reason.text)));
  if (const std::size_t others = reasons_.size() - std::min(reasons_.size(), kReasons); others > 0)
    lines.push_back(fmt::format("  and {} other reason{}", others, others > 1 ? "s" : ""));
  if (late > 0)
    lines.push_back(fmt::format("not settled by the end: {} of {} runs{} (no {}), first run {}", late, may_settle,
                                may_settle < runs ? " whose law makes agents agree" : "", kSettled, first_late));
  return lines;
}

/// In the order of their first runs.
std::vector<Outcomes::Group> Outcomes::Groups() const {
  const SweepPlan::Representatives representatives = plan_.RepresentativesOf(SweepPlan::Alike::kInValues);
  std::vector<std::size_t> group_of(has_failed_.size());
  std::vector<Group> groups;
  for (std::size_t run = 0; run < has_failed_.size(); ++run) {
    if (representatives[run] == run) groups.emplace_back();
    group_of[run] = representatives[run] == run ? groups.size() - 1 : group_of[representatives[run]];
    groups[group_of[run]].push_back(run);
  }
  return groups;
}

void Outcomes::WriteStatistics(std::span<const std::string> metrics,
                               const std::function<void(std::string_view)>& write) const {
  Cells header;
  for (const std::string& key : plan_.keys())
    if (key != kSeedKey) header.push_back(key);
  for (const char* name : {"metric", "runs", "failed", "without_value", "mean", "mean_low_95", "mean_high_95", "median",
                           "decile_1", "decile_9"})
    header.emplace_back(name);
  write(SweepRow(header));
  const std::vector<Group> groups = Groups();
  for (const std::string& metric : metrics) {
    const std::vector<double>& values = ValuesOf(metric);
    if (values.empty()) continue;
    for (const Group& group : groups)
      if (CanHave(group.front(), metric)) write(StatisticsLine(metric, values, group));
  }
}

std::string Outcomes::StatisticsLine(const std::string& metric, const std::vector<double>& values,
                                     const Group& group) const {
  ValueSample sample;
  std::size_t failed = 0;
  for (const std::size_t run : group) {
    if (!std::isnan(values[run])) sample.values.push_back(values[run]);
    failed += has_failed_[run];
  }
  const std::size_t without = group.size() - failed - sample.values.size();
  if (IsTimeOfEvent(metric)) sample.beyond = without;
  const Spread spread = SpreadOf(sample);
  const bool bounded = spread.mean && spread.half_width;
  Cells line;
  const SweepPoint point = plan_[group.front()];
  for (const Override& override : point.overrides)
    if (override.key != kSeedKey) line.push_back(override.value);
  line.push_back(metric);
  for (const std::size_t count : {group.size(), failed, without}) line.push_back(std::to_string(count));
  line.push_back(CellOf(spread.mean));
  line.push_back(bounded ? CellOf(*spread.mean - *spread.half_width) : "");
  line.push_back(bounded ? CellOf(*spread.mean + *spread.half_width) : "");
  for (const auto& value : {spread.median, spread.decile_1, spread.decile_9}) line.push_back(CellOf(value));
  return SweepRow(std::move(line));
}

}  // namespace mascot
