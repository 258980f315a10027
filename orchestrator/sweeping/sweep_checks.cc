#include "orchestrator/sweeping/sweep_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <vector>

namespace mascot {
namespace {

/// Executes tasks, several at a time, and hands each to `take` as it is done, in any order, until that returns false.
void ExecuteTasks(std::span<const std::size_t> tasks, WorkerPool& pool, StopSignal& stop,
                  const std::function<bool(const WorkerPool::Done&)>& take) {
  bool go_on = true;
  for (auto next = tasks.begin(); (go_on && next != tasks.end()) || pool.IsBusy();) {
    while (go_on && next != tasks.end() && pool.HasIdle()) pool.Start(*next++);
    if (const auto done = pool.Wait(std::chrono::milliseconds(100)); done && go_on) go_on = take(*done);
    ThrowIfInterrupted(stop);
  }
}

/// The values in which a trial differs from the first run: "law.name = rendezvous".
std::string DifferenceOf(const SweepPoint& trial, const SweepPoint& first) {
  std::string text;
  for (std::size_t k = 0; k < trial.overrides.size(); ++k)
    if (const Override& set = trial.overrides[k]; set.value != first.overrides[k].value)
      text.append(text.empty() ? "" : ", ").append(set.key).append(" = ").append(set.value);
  return text;
}

/// Mistakes of the rows of a table. Those that have the same text, but for the row, count as one.
class RowMistakes {
 public:
  /// Adds a mistake, a line of text, of a row.
  void Add(const SweepPoint& row, const std::string& mistake) {
    std::string same = mistake;
    for (std::size_t k = 0; k < row.overrides.size(); ++k)
      if (const std::string place = row.overrides[k].origin + ": "; mistake.starts_with(place))
        same = fmt::format("{} {}", k, mistake.substr(place.size()));
    const auto [place, is_new] = place_of_.emplace(same, list_.size());
    if (is_new) list_.push_back({.text = mistake});
    ++list_[place->second].rows;
  }

  std::vector<std::string> Texts() const {
    constexpr std::size_t kMaxMistakes = 20;  // that are named
    std::vector<std::string> texts;
    for (const Mistake& mistake : std::span(list_).first(std::min(list_.size(), kMaxMistakes)))
      texts.push_back(mistake.text + (mistake.rows > 1 ? fmt::format(" (and in {} more rows)", mistake.rows - 1) : ""));
    if (list_.size() > kMaxMistakes)
      texts.push_back(fmt::format("sweep: {} more mistakes", list_.size() - kMaxMistakes));
    return texts;
  }

 private:
  struct Mistake {
    std::string text;
    std::size_t rows = 0;
  };
  std::vector<Mistake> list_;
  std::map<std::string, std::size_t> place_of_;  // in list_, by text without the row
};

}  // namespace

void ThrowIfInterrupted(StopSignal& stop) {
  if (const int signal = stop.Within(std::chrono::nanoseconds::zero()); signal != 0) throw Interrupted{signal};
}

CheckedRun SweepChecks::FirstValid(bool first_alone) {
  std::string mistakes;
  std::optional<CheckedRun> valid;
  for (std::size_t run = 0; run < (first_alone ? 1 : sweep_.plan.size()) && !valid; ++run) {
    const std::size_t task = tasks_.CheckOfRun(run);
    ExecuteTasks({&task, 1}, pool_, stop_, [&](const WorkerPool::Done& done) {
      if (done.failure.empty()) valid = CheckedRunFrom(done.answer);
      if (mistakes.empty()) mistakes = done.failure;
      return true;
    });
  }
  if (!valid) throw ConfigError({mistakes});
  return *valid;
}

KnownLaws SweepChecks::Laws() {
  KnownLaws known;
  bool by_numbers = false;
  for (const auto alike : {SweepPlan::Alike::kInWords, SweepPlan::Alike::kInValues}) {
    known.alike = alike;
    const SweepPlan::Representatives representatives = sweep_.plan.RepresentativesOf(alike);
    std::vector<std::size_t> tasks;
    for (std::size_t run = 0; run < sweep_.plan.size(); ++run)
      if (representatives[run] == run && !known.of_run.contains(run)) tasks.push_back(tasks_.CheckOfRun(run));
    ExecuteTasks(tasks, pool_, stop_, [&](const WorkerPool::Done& done) {
      const std::size_t run = tasks_.RunOfCheck(done.task);
      const bool valid = done.failure.empty();
      if (valid) known.of_run[run] = CheckedRunFrom(done.answer).laws;
      by_numbers = by_numbers || !valid || known.of_run[run].depend_on_numbers;
      return true;
    });
    if (!by_numbers) break;
  }
  return known;
}

std::vector<PythonMetric> SweepChecks::Metrics(const std::vector<std::string>& other_columns) {
  std::vector<PythonMetric> list;
  if (!sweep_.own) return list;
  const std::size_t task = tasks_.ListMetrics();
  ExecuteTasks({&task, 1}, pool_, stop_, [&](const WorkerPool::Done& done) {
    if (!done.failure.empty()) throw ConfigError({"--metric: " + done.failure});
    list = MetricsFrom(done.answer);
    return true;
  });
  for (const PythonMetric& metric : list)
    if (std::ranges::find(other_columns, metric.name) != other_columns.end())
      throw ConfigError({"--metric: expected names that no other column has, got '" + metric.name + "'"});
  return list;
}

std::map<std::size_t, std::string> SweepChecks::MistakesOfTrials() {
  std::vector<std::size_t> tasks(sweep_.plan.TrialCount());
  std::iota(tasks.begin(), tasks.end(), tasks_.CheckOfTrial(0));
  std::map<std::size_t, std::string> mistakes;
  ExecuteTasks(tasks, pool_, stop_, [&](const WorkerPool::Done& done) {
    if (!done.failure.empty()) mistakes[done.task - tasks.front()] = done.failure;
    return true;
  });
  return mistakes;
}

void SweepChecks::CheckTrials() {
  const std::map<std::size_t, std::string> mistakes = MistakesOfTrials();
  if (mistakes.empty()) return;
  const auto& [trial, text] = *mistakes.begin();
  throw ConfigError({fmt::format("sweep: the first run with {}: {} (--force flies the other runs)",
                                 DifferenceOf(sweep_.plan.Trial(trial), sweep_.plan[0]), text)});
}

void SweepChecks::CheckRows() {
  RowMistakes mistakes;
  for (const auto& [trial, text] : MistakesOfTrials()) {
    const SweepPoint row = sweep_.plan.Trial(trial);
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) mistakes.Add(row, line);
  }
  if (const std::vector<std::string> texts = mistakes.Texts(); !texts.empty()) throw ConfigError(texts);
}

void SweepChecks::CheckSeeds(const CheckedRun& first) {
  std::vector<std::size_t> runs = sweep_.plan.WithFirstSeed();
  if (runs.empty() || !first.draws.empty()) return;
  for (std::size_t& run : runs) run = tasks_.CheckOfRun(run);
  bool draws = false;
  ExecuteTasks(runs, pool_, stop_, [&](const WorkerPool::Done& done) {
    draws = done.failure.empty() && !CheckedRunFrom(done.answer).draws.empty();
    return !draws;
  });
  const std::span<const std::string> seeds = sweep_.plan.ValuesOf(kSeedKey);
  if (!draws)
    throw ConfigError(
        {fmt::format("sweep: expected one run.seed, because every seed gives the same run (nothing is "
                     "drawn: no places, edges, loss, jitter, noise, gusts or lies at random, no law that "
                     "draws), got {} (--force flies them all)",
                     std::set<std::string>(seeds.begin(), seeds.end()).size())});
}

}  // namespace mascot
