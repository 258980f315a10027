#include "orchestrator/searching/tuner.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "agent/laws/laws.h"
#include "base/number.h"
#include "orchestrator/sweeping/plan/plan_table.h"
#include "orchestrator/sweeping/plan/values.h"
#include "orchestrator/sweeping/sweep_checks.h"
#include "orchestrator/sweeping/table/table.h"

namespace mascot {
namespace {

/// Throws ConfigError for a key whose values no search may choose.
void CheckSearched(const std::string& key) {
  if (key == kSeedKey)
    throw ConfigError({fmt::format("tune: expected --seeds for several values of {}, got --set", kSeedKey)});
  if (IsInside(kLawKey, key))
    throw ConfigError(
        {fmt::format("tune: expected one law, got several values of {} (orchestrator sweep compares laws)", key)});
}

/// Whether an optimiser may begin with this value.
bool IsPossible(const SearchedKey& key, const std::string& value) {
  if (!key.choices.empty()) return std::ranges::find(key.choices, value) != key.choices.end();
  const auto number = NumberFrom<double>(value);
  return number && *number >= key.range.min && *number <= key.range.max;
}

}  // namespace

std::optional<double> Judged(std::vector<std::optional<double>> values, OverSeeds how, bool maximize) {
  // Best first, those without a value last.
  std::ranges::sort(values, [&](const auto& a, const auto& b) {
    if (!a || !b) return a.has_value() && !b.has_value();
    return maximize ? *a > *b : *a < *b;
  });
  if (how == OverSeeds::kWorst) return values.back();
  if (how == OverSeeds::kMedian) {
    const auto& low = values[(values.size() - 1) / 2];
    const auto& high = values[values.size() / 2];
    return low && high ? std::optional(std::midpoint(*low, *high)) : std::nullopt;
  }
  double sum = 0;
  for (const std::optional<double>& value : values) {
    if (!value) return std::nullopt;
    sum += *value;
  }
  return sum / static_cast<double>(values.size());
}

Tuner::Tuner(std::string name, std::string text, Setting setting)
    : name_(std::move(name)), text_(std::move(text)), setting_(std::move(setting)) {
  const SweepPlan all({.sets = setting_.sets, .randoms = setting_.randoms, .seeds = setting_.seeds});
  for (const std::string& word : setting_.sets) {
    const std::string key = word.substr(0, word.find('='));
    const auto values = all.ValuesOf(key);
    if (values.size() == 1) {
      fixed_.sets.push_back(word);
      continue;
    }
    CheckSearched(key);
    SearchedKey& searched = keys_.emplace_back();
    searched.range.key = key;
    searched.choices.assign(values.begin(), values.end());
    options_.push_back("--set " + word);
  }
  for (const std::string& word : setting_.randoms) {
    keys_.emplace_back().range = ParseKeyRange(word);
    options_.push_back("--random " + word);
  }
  fixed_.seeds = setting_.seeds;
  if (keys_.empty())
    throw ConfigError(
        {"tune: expected a key to choose values of, --random KEY=MIN:MAX or --set KEY=V1,V2,..., got none"});
}

std::vector<std::string> Tuner::keys() const {
  std::vector<std::string> names;
  for (const SearchedKey& key : keys_) names.push_back(key.range.key);
  return names;
}

std::vector<std::string> Tuner::log_keys() const {
  std::vector<std::string> names;
  for (const SearchedKey& key : keys_)
    if (key.range.log) names.push_back(key.range.key);
  return names;
}

SweepPlan Tuner::PlanOf(std::span<const Candidate> rows) const {
  PlanTable table{.name = "tune", .keys = keys(), .rows = {}, .options = options_};
  for (const Candidate& row : rows) table.rows.push_back({.line = table.rows.size() + 1, .values = row});
  return {fixed_, table};
}

std::vector<std::string> Tuner::OptionsOf(const Candidate& values) const {
  std::vector<std::string> options;
  for (const std::string& set : fixed_.sets) options.push_back("--set " + set);
  for (std::size_t k = 0; k < keys_.size(); ++k)
    options.push_back(fmt::format("--set {}={}", keys_[k].range.key, values[k]));
  return options;
}

/// The values that the experiment has without the search, if the search may choose them.
std::optional<Candidate> Tuner::InTheFile() const {
  try {
    SweepPlan::Words words;
    words.sets = fixed_.sets;
    const std::vector<Override> overrides = SweepPlan(words)[0].overrides;
    const Experiment experiment = LoadExperiment(text_, name_, overrides, UserCode::kNeverRuns);
    const auto values = PlainKeys(Section::FromText(experiment.resolved, name_).InTheFile());
    Candidate candidate;
    for (const SearchedKey& key : keys_) {
      const auto value = values.find(key.range.key);
      if (value == values.end()) return std::nullopt;
      candidate.push_back(PlainValue(key.range.key, value->second));
      if (!IsPossible(key, candidate.back())) return std::nullopt;
    }
    return candidate;
  } catch (const ConfigError&) {  // it is no experiment without the values that are chosen
    return std::nullopt;
  }
}

/// All that the candidates depend on, beside what a sweep depends on.
std::string Tuner::Text(const std::string& optimizer) const {
  const std::string column = setting_.metric.empty() ? "the first metric" : setting_.metric;
  return fmt::format("{} {}, {} over seeds, {}, batches of {}, optimiser's seed {}, {}",
                     setting_.maximize ? "largest" : "smallest", column, kOverSeeds.Name(setting_.over_seeds),
                     fmt::join(options_, ", "), setting_.batch, setting_.seed, optimizer);
}

/// What is known in the course of a search.
class Tuner::Course {
 public:
  Course(const Tuner& tuner, const Options& options, StopSignal& stop)
      : tuner_(tuner),
        options_(options),
        stop_(stop),
        first_(tuner.InTheFile()),
        optimizer_(tuner.keys_, {.seed = tuner.setting_.seed, .maximize = tuner.setting_.maximize, .first = first_},
                   stop),
        search_(tuner.Text(optimizer_.name())) {}

  Outcome Run() {
    const Setting& setting = tuner_.setting_;
    outcome_.optimizer = optimizer_.name();
    outcome_.begins_with_file = first_.has_value();
    const Candidate any(tuner_.keys_.size(), "0");
    outcome_.runs_per_row = tuner_.PlanOf(std::span(&any, 1)).size();
    try {
      FlyBegun();
      for (std::size_t asked = 0; asked < setting.budget; asked += setting.batch) {
        std::vector<Candidate> candidates = optimizer_.Ask(setting.batch);
        // The last batch may be larger than what is left of the budget. A larger budget then goes on with the rest.
        const bool whole = setting.budget - asked >= setting.batch;
        if (!whole) candidates.resize(setting.budget - asked);
        std::vector<std::size_t> rows;
        for (const Candidate& candidate : candidates) rows.push_back(RowOf(candidate));
        if (outcome_.rows.size() > flown_) Fly(outcome_.rows.size());
        std::vector<std::optional<double>> values;
        for (const std::size_t row : rows) values.push_back(outcome_.rows[row].value);
        if (whole) optimizer_.Tell(values);
      }
    } catch (const Interrupted& interrupted) {
      outcome_.signal = interrupted.signal;
    }
    return outcome_;
  }

 private:
  /// Takes over the candidates of an interrupted search at the same place.
  void FlyBegun() {
    const auto begun = SweepIdentity::FromText(PlanBeside(options_.out));
    if (options_.force || !std::filesystem::exists(options_.out) || !begun || begun->search != search_ ||
        begun->experiment != tuner_.text_)
      return;
    const SweepPlan plan(begun->words);
    for (std::size_t run = 0; run < plan.size(); run += outcome_.runs_per_row) {
      const SweepPoint point = plan[run];
      Candidate candidate;
      for (const SearchedKey& key : tuner_.keys_)
        for (const Override& set : point.overrides)
          if (set.key == key.range.key) candidate.push_back(set.value);
      RowOf(candidate);
    }
    Fly(outcome_.rows.size());
    next_ = 0;
  }

  /// The row of a candidate, which is added if there is none. Throws ConfigError if the table has another one there.
  std::size_t RowOf(const Candidate& candidate) {
    const auto [place, is_new] = row_of_.emplace(candidate, outcome_.rows.size());
    if (is_new) outcome_.rows.push_back({.values = candidate, .value = {}});
    if (place->second > next_ || (is_new && next_ < flown_))
      throw ConfigError(
          {fmt::format("--out {}: expected the candidates that {} proposes here, got others (--force begins "
                       "anew)",
                       options_.out, optimizer_.name())});
    next_ = std::max(next_, place->second + 1);
    return place->second;
  }

  /// Flies what is missing of the first rows, and takes their figures.
  void Fly(std::size_t rows) {
    std::vector<Candidate> candidates;
    for (std::size_t row = 0; row < rows; ++row) candidates.push_back(outcome_.rows[row].values);
    const Sweeper sweeper(tuner_.name_, tuner_.text_, tuner_.PlanOf(candidates));
    outcome_.sweep = sweeper.Fly(SweeperOptions(), stop_);
    if (outcome_.sweep.signal != 0) throw Interrupted{outcome_.sweep.signal};
    flown_ = rows;
    outcome_.column = outcome_.sweep.column;
    const std::size_t runs = outcome_.runs_per_row;
    for (std::size_t row = 0; row < rows; ++row) {
      const auto first = outcome_.sweep.values.begin() + static_cast<std::ptrdiff_t>(row * runs);
      outcome_.rows[row].value = Judged({first, first + static_cast<std::ptrdiff_t>(runs)}, tuner_.setting_.over_seeds,
                                        tuner_.setting_.maximize);
    }
    outcome_.best = Best();
  }

  Sweeper::Options SweeperOptions() {
    Sweeper::Options options{.jobs = options_.jobs,
                             .out = options_.out,
                             .metric = tuner_.setting_.metric,
                             .metric_file = tuner_.setting_.metric_file,
                             .force = options_.force && flown_ == 0,
                             .quiet = true,
                             .search = search_};
    if (options_.watch)
      options.watch = [this](std::size_t in_table) {
        options_.watch(in_table, tuner_.setting_.budget * outcome_.runs_per_row,
                       outcome_.best ? outcome_.rows[*outcome_.best].value : std::nullopt);
      };
    return options;
  }

  std::optional<std::size_t> Best() const {
    std::optional<std::size_t> best;
    for (std::size_t row = 0; row < flown_; ++row) {
      const std::optional<double>& value = outcome_.rows[row].value;
      if (!value) continue;
      const bool better = !best || (tuner_.setting_.maximize ? *value > *outcome_.rows[*best].value
                                                             : *value < *outcome_.rows[*best].value);
      if (better) best = row;
    }
    return best;
  }

  const Tuner& tuner_;
  const Options& options_;
  StopSignal& stop_;
  const std::optional<Candidate> first_;
  Optimizer optimizer_;
  const std::string search_;
  Outcome outcome_;
  std::map<Candidate, std::size_t> row_of_;
  std::size_t flown_ = 0;  // rows whose figures are known
  std::size_t next_ = 0;   // the row of the next new candidate
};

Tuner::Outcome Tuner::Search(const Options& options, StopSignal& stop) const {
  return Course(*this, options, stop).Run();
}

}  // namespace mascot
