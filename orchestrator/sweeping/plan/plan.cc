#include "orchestrator/sweeping/plan/plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "base/number.h"
#include "base/random.h"
#include "orchestrator/sweeping/plan/plan_table.h"
#include "orchestrator/sweeping/plan/values.h"

namespace mascot {
namespace {

constexpr std::uint64_t kSamplesSeed = 1;

[[noreturn]] void Refuse(const std::string& option, const std::string& expected, const std::string& got) {
  throw ConfigError({option + ": expected " + expected + ", got '" + got + "'"});
}

std::optional<double> ToNumber(std::string_view text) {
  const auto value = NumberFrom<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

/// Whether one of the values of a key is no number.
bool HasWords(const std::vector<std::string>& values) {
  return std::ranges::any_of(values, [](const std::string& value) { return !ToNumber(value); });
}

/// The TOML string at the front of `text`, with its quotes; empty if there is none.
std::string_view StringAtFront(std::string_view text) {
  if (text.empty() || (text[0] != '"' && text[0] != '\'')) return {};
  const std::string triple(3, text[0]);
  const std::string_view quote = text.starts_with(triple) ? text.substr(0, 3) : text.substr(0, 1);
  for (std::size_t i = quote.size(); i < text.size(); ++i) {
    if (text.substr(i).starts_with(quote)) return text.substr(0, i + quote.size());
    if (text[i] == '\\' && quote[0] == '"') ++i;
  }
  return text;
}

/// Splits `text` at the separators outside brackets, braces and quotes.
std::vector<std::string> Split(std::string_view text, char separator) {
  std::vector<std::string> parts(1);
  int depth = 0;
  while (!text.empty()) {
    const std::string_view string = StringAtFront(text);
    const std::string_view token = string.empty() ? text.substr(0, 1) : string;
    text.remove_prefix(token.size());
    depth += (token == "[" || token == "{") - (token == "]" || token == "}");
    if (token[0] == separator && depth == 0)
      parts.emplace_back();
    else
      parts.back() += token;
  }
  return parts;
}

/// A value of PlainValue() as one that --set takes for one: a string without quotes may look like several values, or
/// like a range.
std::string Typed(const std::string& value) {
  const bool is_word = std::isalpha(static_cast<unsigned char>(value.front())) != 0;
  return is_word && value.find_first_of(",:[]{}\"'") != std::string::npos ? ToToml({value}) : value;
}

/// Splits KEY=VALUES at the first equals sign.
std::pair<std::string, std::string> SplitKey(const std::string& option, const std::string& word) {
  const auto equals = word.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == word.size())
    Refuse(option, option == "--set" ? "key=values (such as law.p_gain=0.1:0.1:1)" : "key=min:max[:log]", word);
  return {word.substr(0, equals), word.substr(equals + 1)};
}

/// Rounds to 15 significant digits, so that 0.3 + 6 x 0.1 gives 0.9.
double Rounded(double value) { return std::strtod(fmt::format("{:.15g}", value).c_str(), nullptr); }

/// The values of A:STEP:B in integer arithmetic; nothing if the three are not integers.
std::optional<std::vector<std::string>> IntegerRange(const std::vector<std::string>& parts) {
  const auto a = NumberFrom<std::int64_t>(parts[0]), step = NumberFrom<std::int64_t>(parts[1]),
             b = NumberFrom<std::int64_t>(parts[2]);
  if (!a || !step || !b) return std::nullopt;
  std::vector<std::string> values;
  for (std::int64_t value = *a; *step > 0 ? value <= *b : value >= *b;) {
    values.push_back(std::to_string(value));
    if (__builtin_add_overflow(value, *step, &value)) break;
  }
  return values;
}

/// The values of A:STEP:B, both ends included: A + i STEP, without accumulation. B is included even if a rounding error
/// would miss it.
std::vector<std::string> RangeValues(std::string_view key, const std::string& word,
                                     const std::vector<std::string>& parts) {
  const auto first = ToNumber(parts[0]), step = ToNumber(parts[1]), last = ToNumber(parts[2]);
  if (!first || !step || !last || *step == 0 || (*last - *first) / *step < 0)
    Refuse("--set", "a:step:b, three numbers with b on step's side of a", word);
  constexpr double kRounding = 1e-9;
  const double steps = std::floor((*last - *first) / *step + kRounding);
  if (steps >= static_cast<double>(kMaxRuns)) Refuse("--set", "at most 10000000 values", word);
  if (auto integers = IntegerRange(parts)) return *integers;
  std::vector<double> values;
  for (std::size_t i = 0; i <= static_cast<std::size_t>(steps); ++i)
    values.push_back(Rounded(*first + static_cast<double>(i) * *step));
  return PlainNumbers(key, values);
}

std::optional<std::int64_t> ToSeed(std::string_view text) {
  const auto seed = NumberFrom<std::int64_t>(text);
  return seed && *seed >= 0 ? seed : std::nullopt;
}

/// The bounds of a range in their shortest form: "0.1:1".
std::string RangeText(const std::vector<double>& bounds) { return fmt::format("{}", fmt::join(bounds, ":")); }

std::vector<std::string> ParseSeeds(const std::string& text) {
  std::vector<std::string> seeds;
  if (const auto dots = text.find(".."); dots != std::string::npos) {
    const auto first = ToSeed(text.substr(0, dots)), last = ToSeed(text.substr(dots + 2));
    if (!first || !last || *last < *first) Refuse("--seeds", "a..b or a,b,... of integers from 0 on", text);
    if (*last - *first >= static_cast<std::int64_t>(kMaxRuns))
      Refuse("--seeds", fmt::format("at most {} seeds", kMaxRuns), text);
    for (std::int64_t seed = *first; seed <= *last; ++seed) seeds.push_back(std::to_string(seed));
    return seeds;
  }
  for (const std::string& part : Split(text, ',')) {
    if (!ToSeed(part)) Refuse("--seeds", "a..b or a,b,... of integers from 0 on", text);
    seeds.push_back(std::to_string(*ToSeed(part)));
  }
  return seeds;
}

/// "4..6", "1,3".
std::string SeedsText(const std::vector<std::string>& seeds) {
  const std::int64_t first = *ToSeed(seeds.front());
  for (std::size_t k = 0; k < seeds.size(); ++k)
    if (ToSeed(seeds[k]) != first + static_cast<std::int64_t>(k)) return fmt::format("{}", fmt::join(seeds, ","));
  return fmt::format("{}..{}", seeds.front(), seeds.back());
}

/// A key, and how many values it is given.
struct ValueCount {
  std::string key;
  std::size_t values;
};

/// Throws ConfigError unless --zip has several keys to take the values of together, all with as many. `counts`: of the
/// keys of several values.
void CheckZip(const std::vector<ValueCount>& counts) {
  if (counts.size() < 2)
    throw ConfigError({fmt::format("--zip: expected at least 2 keys with --set KEY=VALUES of several values, got {}",
                                   counts.empty() ? "none" : "1, " + counts.front().key)});
  const auto is_other = [&](const ValueCount& count) { return count.values != counts.front().values; };
  if (std::ranges::none_of(counts, is_other)) return;
  std::vector<std::string> texts;
  for (const auto& [key, values] : counts) texts.push_back(fmt::format("{} of {}", values, key));
  throw ConfigError({fmt::format("--zip: expected as many values of each key, got {}", fmt::join(texts, ", "))});
}

/// Throws ConfigError for options that say otherwise than the rows of a table.
void CheckBesideTable(const SweepPlan::Words& words, const PlanTable& table) {
  if (words.zip)
    throw ConfigError({fmt::format("--zip: expected no --plan, because a row of {} is a run already", table.name)});
  const bool has_seeds = std::ranges::find(table.keys, kSeedKey) != table.keys.end();
  if (has_seeds && !words.seeds.empty())
    throw ConfigError({fmt::format("--seeds: expected no column {} in {}, which gives each run its seed, got both",
                                   kSeedKey, table.name)});
}

}  // namespace

bool IsInside(std::string_view key, std::string_view table) {
  return key.starts_with(table) && (key.size() == table.size() || key[table.size()] == '.' || key[table.size()] == '[');
}

SweepPlan::Axis SweepPlan::ParseSet(const std::string& word) {
  const auto [key, text] = SplitKey("--set", word);
  const std::vector<std::string> range = Split(text, ':');
  if (range.size() == 3 && ToNumber(range[0]))
    return {.key = key,
            .values = RangeValues(key, word, range),
            .is_range = true,
            .range = RangeText({*ToNumber(range[0]), *ToNumber(range[1]), *ToNumber(range[2])})};
  Axis axis{key, Split(text, ',')};
  if (std::ranges::find(axis.values, "") != axis.values.end()) Refuse("--set", "values between commas", word);
  for (std::string& value : axis.values) value = PlainValue(key, value);
  return axis;
}

KeyRange ParseKeyRange(const std::string& word) {
  const auto [key, text] = SplitKey("--random", word);
  const std::vector<std::string> parts = Split(text, ':');
  const auto min = ToNumber(parts[0]), max = parts.size() > 1 ? ToNumber(parts[1]) : std::nullopt;
  const bool log = parts.size() == 3 && parts[2] == "log";
  if (!min || !max || *min > *max || (parts.size() == 3 && !log) || parts.size() > 3 || (log && *min <= 0))
    Refuse("--random", "key=min:max with min <= max, or key=min:max:log with 0 < min <= max", word);
  if (!std::isfinite(log ? *max / *min : *max - *min)) Refuse("--random", "a range that a double can span", word);
  return {.key = key, .min = *min, .max = *max, .log = log};
}

std::string KeyRange::Text() const { return RangeText({min, max}) + (log ? ":log" : ""); }

/// Draws the values of a --random key. Each key has its own random stream, chosen by its `place` among these options.
SweepPlan::Axis SweepPlan::ParseRandom(const std::string& word, std::uint64_t place, std::int64_t samples) {
  const KeyRange range = ParseKeyRange(word);
  Random random(kSamplesSeed + place, Random::Stream::kSweep);
  Axis axis{.key = range.key, .values = {}, .range = range.Text()};
  for (std::int64_t i = 0; i < samples; ++i) {
    const double fraction = random.Unit();
    axis.drawn.push_back(range.log ? range.min * std::pow(range.max / range.min, fraction)
                                   : range.min + fraction * (range.max - range.min));
  }
  return axis;
}

/// Leaves the first of equal values, and says so: equal runs are no sample.
void SweepPlan::KeepEachOnce(Axis& axis) {
  const std::size_t given = axis.values.size();
  std::unordered_set<std::string> there;
  std::erase_if(axis.values, [&](const std::string& value) { return !there.insert(value).second; });
  if (axis.values.size() < given)
    notes_.push_back(fmt::format("{}: {} of the {} values are equal to others: each is flown once", axis.key,
                                 given - axis.values.size(), given));
}

/// Leaves one of the samples if all are equal: ranges from a number to itself.
void SweepPlan::KeepOneIfEqual(std::vector<Axis>& drawn) {
  const auto is_one = [](const Axis& axis) {
    return std::ranges::adjacent_find(axis.drawn, std::not_equal_to<>()) == axis.drawn.end();
  };
  if (drawn.empty() || drawn.front().size() == 1 || !std::ranges::all_of(drawn, is_one)) return;
  notes_.push_back(fmt::format("--samples: the {} are equal: one is flown", drawn.front().size()));
  for (Axis& axis : drawn) axis.drawn.resize(1);
}

/// Notes a key and its values. Throws ConfigError if another axis sets the key, or what is inside of it.
void SweepPlan::AddAxis(const Axis& axis) {
  for (const std::string& key : keys_)
    if (IsInside(key, axis.key) || IsInside(axis.key, key))
      throw ConfigError(
          {"sweep: expected each key once, got " + axis.key + (key == axis.key ? " again" : " and " + key)});
  keys_.push_back(axis.key);
  axes_.push_back(axis);
  if (axis.size() > 1 && axis.key != kSeedKey) varied_.push_back(axis.key);
}

/// Every run so far becomes `by` runs. Throws ConfigError if these are too many.
void SweepPlan::Multiply(std::size_t by) {
  if (size_ > kMaxRuns / std::max<std::size_t>(by, 1))
    throw ConfigError({"sweep: expected at most 10000000 runs, got more"});
  size_ *= by;
  row_stride_ *= by;
  for (Axis& axis : axes_) axis.stride *= by;
}

/// `sets`: how many keys --set gives; they come first.
void SweepPlan::AddTrials(std::size_t sets) {
  for (std::size_t k = 0; k < sets; ++k) {
    const Axis& axis = axes_[k];
    for (std::size_t i = axis.is_range ? std::max<std::size_t>(axis.size() - 1, 1) : 1; i < axis.size(); ++i)
      trials_.push_back({.axis = k, .number = i});
  }
}

void SweepPlan::AddTrialsOfRows(std::size_t sets) {
  const auto is_range = [](const Axis& axis) { return axis.is_range || axis.size() == 1; };
  const bool last_alone = !IsOfTable() && std::ranges::all_of(std::span(axes_).first(sets), is_range);
  const std::size_t first = IsOfTable() ? 0 : last_alone ? std::max<std::size_t>(rows_ - 1, 1) : 1;
  for (std::size_t row = first; row < rows_; ++row) trials_.push_back({.axis = {}, .number = row});
}

SweepPoint SweepPlan::Trial(std::size_t number) const {
  const TrialPlace& trial = trials_[number];
  if (!trial.axis) return (*this)[trial.number * row_stride_];
  SweepPoint point = (*this)[0];
  point.overrides[*trial.axis].value = axes_[*trial.axis].Value(trial.number);
  return point;
}

void SweepPlan::AddProduct(std::vector<Axis> sets) {
  for (Axis& axis : sets) {
    KeepEachOnce(axis);
    Multiply(axis.size());
    AddAxis(axis);
  }
}

/// The columns of a table, with a value for each row.
std::vector<SweepPlan::Axis> SweepPlan::ColumnsOf(const PlanTable& table) {
  std::vector<Axis> columns;
  for (std::size_t k = 0; k < table.keys.size(); ++k) {
    Axis& axis = columns.emplace_back();
    axis.key = table.keys[k];
    axis.column = k + 1;
    if (!table.options.empty()) axis.option = table.options[k];
    for (const PlanTable::Row& row : table.rows) axis.values.push_back(row.values[k]);
  }
  return columns;
}

/// Leaves the first of equal rows, and says so. `option`: what gave the rows.
void SweepPlan::KeepEachRowOnce(std::vector<Axis>& sets, std::size_t rows, const std::string& option) {
  std::unordered_set<std::string> there;
  std::vector<std::size_t> kept;
  for (std::size_t row = 0; row < rows; ++row) {
    std::string text;
    for (const Axis& axis : sets)
      if (axis.size() > 1) text.append(axis.values[row]).push_back('\0');
    if (there.insert(std::move(text)).second) kept.push_back(row);
  }
  rows_ = kept.size();
  if (rows_ == rows) return;
  notes_.push_back(
      fmt::format("{}: {} of the {} rows are equal to others: each is flown once", option, rows - rows_, rows));
  const auto keep = [&](auto& list) {
    for (std::size_t k = 0; k < kept.size(); ++k) list[k] = list[kept[k]];
    list.resize(kept.size());
  };
  if (IsOfTable()) keep(lines_);
  for (Axis& axis : sets) {
    if (axis.size() == 1) continue;
    keep(axis.values);
    axis.is_range = false;
  }
}

/// Keys with several values have as many as there are rows. `option`: what gave the rows.
void SweepPlan::AddRows(std::vector<Axis> sets, const std::string& option) {
  std::size_t rows = 1;
  for (const Axis& axis : sets) rows = std::max(rows, axis.size());
  KeepEachRowOnce(sets, rows, option);
  for (Axis& axis : sets)
    if (std::ranges::adjacent_find(axis.values, std::not_equal_to<>()) == axis.values.end()) axis.values.resize(1);
  Multiply(rows_);
  row_stride_ = 1;  // what is added from now on changes faster
  for (const Axis& axis : sets) AddAxis(axis);
  is_zipped_ = std::ranges::count_if(sets, [](const Axis& axis) { return axis.size() > 1; }) > 1;
}

SweepPlan::SweepPlan(const Words& words) : SweepPlan(words, nullptr) {}

SweepPlan::SweepPlan(const Words& words, const PlanTable& table) : SweepPlan(words, &table) {}

SweepPlan::SweepPlan(const Words& words, const PlanTable* table) {
  std::vector<Axis> sets;
  for (const std::string& word : words.sets) sets.push_back(ParseSet(word));
  const std::size_t set_keys = sets.size() + (table != nullptr ? table->keys.size() : 0);
  if (table != nullptr) {
    CheckBesideTable(words, *table);
    for (std::size_t k = 0; k < sets.size(); ++k)
      if (sets[k].size() > 1)
        Refuse("--set", fmt::format("one value of a key beside the rows of {}", table->name), words.sets[k]);
    table_ = table->name;
    for (const PlanTable::Row& row : table->rows) lines_.push_back(row.line);
    std::ranges::move(ColumnsOf(*table), std::back_inserter(sets));
    AddRows(std::move(sets), table_);
  } else if (words.zip) {
    std::vector<ValueCount> counts;
    for (const Axis& axis : sets)
      if (axis.size() > 1) counts.push_back({axis.key, axis.size()});
    CheckZip(counts);
    AddRows(std::move(sets), "--zip");
  } else {
    AddProduct(std::move(sets));
  }
  std::vector<Axis> drawn;
  for (std::size_t k = 0; k < words.randoms.size(); ++k)
    drawn.push_back(ParseRandom(words.randoms[k], k, words.samples));
  KeepOneIfEqual(drawn);
  if (!drawn.empty()) Multiply(drawn.front().size());
  for (const Axis& axis : drawn) AddAxis(axis);
  if (!words.seeds.empty()) {
    Axis seeds{.key = std::string(kSeedKey), .values = ParseSeeds(words.seeds)};
    KeepEachOnce(seeds);
    has_seeds_ = true;
    Multiply(seeds.size());
    AddAxis(seeds);
  }
  if (words.zip || table != nullptr)
    AddTrialsOfRows(set_keys);
  else
    AddTrials(set_keys);
}

std::string SweepPlan::Axis::Value(std::size_t k) const { return drawn.empty() ? values[k] : ShortestFloat(drawn[k]); }

SweepPoint SweepPlan::operator[](std::size_t run) const {
  SweepPoint point;
  for (const Axis& axis : axes_) {
    Override& set = point.overrides.emplace_back();
    set.key = axis.key;
    set.value = axis.ValueIn(run);
    if (!axis.drawn.empty())
      set.origin = fmt::format("--random {}={} ({})", axis.key, axis.range, set.value);
    else if (IsOfSeeds(axis))
      set.origin = "--seeds " + set.value;
    else if (!axis.option.empty())
      set.origin = fmt::format("{} ({})", axis.option, set.value);
    else if (axis.column != 0)
      set.origin = fmt::format("{}:{}:{}", table_, lines_[run / row_stride_ % rows_], axis.column);
  }
  return point;
}

SweepPlan::Words SweepPlan::words() const {
  Words words;
  words.zip = is_zipped_;
  for (const Axis& axis : axes_) {
    if (!axis.drawn.empty()) {
      words.randoms.push_back(axis.key + "=" + axis.range);
      words.samples = static_cast<std::int64_t>(axis.drawn.size());
    } else if (IsOfSeeds(axis)) {
      words.seeds = SeedsText(axis.values);
    } else {
      std::string values;
      for (const std::string& value : axis.values) values += (values.empty() ? "" : ",") + Typed(value);
      words.sets.push_back(axis.key + "=" + (axis.is_range ? axis.range : values));
    }
  }
  return words;
}

std::string SweepPlan::Text() const {
  std::string text;
  for (const Axis& axis : axes_)
    text += axis.drawn.empty() ? fmt::format("{}={}\n", axis.key, fmt::join(axis.values, ","))
                               : fmt::format("{}={}, {} samples\n", axis.key, axis.range, axis.drawn.size());
  return text + (is_zipped_ ? "row by row\n" : "");
}

bool SweepPlan::BeginsWith(const SweepPlan& other) const {
  if (other.keys_ != keys_ || other.size_ > size_) return false;
  for (std::size_t run = 0; run < other.size_; ++run)
    for (std::size_t k = 0; k < axes_.size(); ++k)
      if (axes_[k].ValueIn(run) != other.axes_[k].ValueIn(run)) return false;
  return true;
}

std::string SweepPlan::SettingOf(std::string_view key) const {
  const auto axis = std::ranges::find(axes_, key, &Axis::key);
  if (axis == axes_.end()) return "";
  return axis->drawn.empty() ? fmt::format("{}", fmt::join(axis->values, ", "))
                             : fmt::format("{}, {} samples", axis->range, axis->drawn.size());
}

std::span<const std::string> SweepPlan::ValuesOf(std::string_view key) const {
  const auto axis = std::ranges::find(axes_, key, &Axis::key);
  return axis == axes_.end() ? std::span<const std::string>() : axis->values;
}

std::size_t SweepPlan::Representatives::operator[](std::size_t run) const {
  std::size_t first = run;
  for (const Digit& digit : digits_) {
    const std::size_t k = run / digit.stride % digit.first.size();
    first -= (k - digit.first[k]) * digit.stride;
  }
  return first;
}

SweepPlan::Representatives SweepPlan::RepresentativesOf(Alike alike) const {
  std::map<std::size_t, std::vector<std::string>> digits;  // by stride: what must be equal, for each value
  for (const Axis& axis : axes_) {
    if (axis.size() == 1) continue;
    std::vector<std::string>& compared = digits[axis.stride];
    compared.resize(axis.size());
    if (axis.key == kSeedKey || (alike == Alike::kInWords && !HasWords(axis.values))) continue;
    for (std::size_t k = 0; k < axis.size(); ++k) compared[k].append(axis.Value(k)).push_back('\0');
  }
  Representatives representatives;
  for (const auto& [stride, compared] : digits) {
    std::unordered_map<std::string_view, std::size_t> first_with;
    Representatives::Digit digit{.stride = stride, .first = {}};
    for (std::size_t k = 0; k < compared.size(); ++k)
      digit.first.push_back(first_with.emplace(compared[k], k).first->second);
    representatives.digits_.push_back(std::move(digit));
  }
  return representatives;
}

std::vector<std::size_t> SweepPlan::WithFirstSeed() const {
  if (std::ranges::find(keys_, kSeedKey) == keys_.end()) return {};
  const Representatives representatives = RepresentativesOf(Alike::kInValues);
  std::vector<std::size_t> runs;
  for (std::size_t run = 0; run < size_; ++run)
    if (representatives[run] == run) runs.push_back(run);
  return runs.size() < size_ ? runs : std::vector<std::size_t>{};
}

bool IsOneValue(const std::string& value) {
  if (value.empty()) return false;
  const std::string typed = Typed(value);
  // A bracket or a quote that stays open would take what follows with it.
  return std::ranges::all_of(std::string_view(",:"), [&](char separator) {
    const std::vector<std::string> parts = Split(typed + separator + "0", separator);
    return parts.size() == 2 && parts[0] == typed;
  });
}

}  // namespace mascot
