#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "experiment/toml/section.h"

namespace mascot {

/// Keys that a sweep treats in a way of their own.
inline constexpr std::string_view kSeedKey = "run.seed", kLawKey = "law.name";

/// The most runs that a sweep may have.
inline constexpr std::size_t kMaxRuns = 10'000'000;

/// One run of a sweep: the keys that it sets, in addition to the experiment file. A mistake that a value makes is
/// reported with the option that gave it: "--set law.beta=-1", "--random law.beta=-1:1 (-0.25)", "--seeds 3".
struct SweepPoint {
  std::vector<Override> overrides;  ///< in the order of SweepPlan::keys()
};

/// A key whose values are chosen from a range, KEY=MIN:MAX[:log].
struct KeyRange {
  std::string key;
  double min = 0, max = 0;
  bool log = false;  ///< it is the logarithm of the value that is chosen

  /// The range in its shortest form: "0.1:1:log".
  std::string Text() const;
};

/// The range that --random gives. Throws ConfigError, naming the option and what was expected.
KeyRange ParseKeyRange(const std::string& word);

struct PlanTable;

/// The runs of a sweep: every combination of key values, random samples and seeds, in this order; seeds change fastest.
/// With --zip, or with a table of rows (plan_table.h), the values of a row belong together: every combination of rows,
/// samples and seeds is flown. The same options give the same plan. A run is made when it is asked for: a plan keeps
/// only the values of its keys.
class SweepPlan {
 public:
  /// Command-line options, as typed.
  struct Words {
    std::vector<std::string> sets;     ///< --set KEY=A:STEP:B | KEY=V1,V2,... | KEY=VALUE
    std::vector<std::string> randoms;  ///< --random KEY=MIN:MAX[:log]
    std::int64_t samples = 1;          ///< --samples: how often all random keys are drawn
    std::string seeds;                 ///< --seeds A..B | A,B,...; "": the seed of the file
    bool zip = false;                  ///< --zip: the k-th values of all --set keys of several values are a row
    bool operator==(const Words&) const = default;
  };
  /// Throws ConfigError for an invalid option, naming the option and what was expected.
  explicit SweepPlan(const Words& words);
  /// The rows of `table` are flown: `words` may set a key to one value, and not zip. A mistake that a value of the
  /// table makes is reported with its place: "plan.csv:3:2".
  SweepPlan(const Words& words, const PlanTable& table);

  /// The options that give the same plan, however they were typed: with values as PlainValue() (values.h) has them,
  /// each once. Those of a table are --set and --zip.
  Words words() const;
  /// Lines for the terminal: the keys to which equal values were given more than once.
  const std::vector<std::string>& notes() const { return notes_; }

  /// The dotted keys that are set: those of --set and --random in the order of the options, then run.seed if --seeds
  /// was given.
  const std::vector<std::string>& keys() const { return keys_; }
  std::size_t size() const { return size_; }
  SweepPoint operator[](std::size_t run) const;
  /// Keys with more than one value, without run.seed: the axes of a plot.
  const std::vector<std::string>& varied() const { return varied_; }
  /// The values of a key, in plain text (values.h); empty if neither --set nor --seeds sets it.
  std::span<const std::string> ValuesOf(std::string_view key) const;
  /// The trials, by number: for each value but the first that --set gives a key, the first run that has it; for each
  /// row but the first, its first run; for each row of a table, its first run. Of the values of A:STEP:B, and of rows
  /// with no other values, only the last one counts.
  std::size_t TrialCount() const { return trials_.size(); }
  SweepPoint Trial(std::size_t number) const;
  /// Whether the trials are the rows of a table.
  bool IsOfTable() const { return !lines_.empty(); }
  /// Which runs count as alike: those that set the same values (kInValues), or the same values of the keys whose values
  /// are not all numbers (kInWords). run.seed may differ in both.
  enum class Alike { kInValues, kInWords };
  /// The representative of each run: the first run that is alike.
  class Representatives {
   public:
    std::size_t operator[](std::size_t run) const;

   private:
    friend SweepPlan;
    /// Keys whose values change together.
    struct Digit {
      std::size_t stride = 1;          ///< the values change after so many runs
      std::vector<std::size_t> first;  ///< for each value, the index of the first one that is alike
    };
    std::vector<Digit> digits_;
  };
  Representatives RepresentativesOf(Alike alike) const;
  /// The first of all runs that differ in run.seed alone, for each such set of runs; none if no two runs do.
  std::vector<std::size_t> WithFirstSeed() const;
  /// Whether keys change together, row by row.
  bool IsZipped() const { return is_zipped_; }
  /// A line for each key with its values, by which plans are compared.
  std::string Text() const;
  /// Whether the first runs of this plan are those of `other`.
  bool BeginsWith(const SweepPlan& other) const;
  /// What a key is set to, in words: "0.1, 0.5", "0.1:1, 20 samples"; empty: it is not set.
  std::string SettingOf(std::string_view key) const;

 private:
  struct Axis {
    std::string key;
    std::vector<std::string> values;
    bool is_range = false;   ///< of A:STEP:B
    std::string range = {};  ///< "0.1:0.1:1", or of --random "0.1:1:log", which has `drawn` in the place of values
    std::vector<double> drawn = {};
    std::size_t column = 0;   ///< of the table that the values are from, counted from 1; 0: they are from none
    std::string option = {};  ///< that gave the values of the table; empty: they stand in a file
    std::size_t stride = 1;   ///< the value changes after so many runs

    std::size_t size() const { return drawn.empty() ? values.size() : drawn.size(); }
    std::string Value(std::size_t k) const;
    std::string ValueIn(std::size_t run) const { return Value(run / stride % size()); }
  };
  /// A run that is checked before the sweep: that of a row, or the first one with another value of one key.
  struct TrialPlace {
    std::optional<std::size_t> axis = {};  ///< nothing: a row
    std::size_t number = 0;                ///< of the value, or of the row
  };
  SweepPlan(const Words& words, const PlanTable* table);
  static Axis ParseSet(const std::string& word);
  static std::vector<Axis> ColumnsOf(const PlanTable& table);
  static Axis ParseRandom(const std::string& word, std::uint64_t place, std::int64_t samples);
  void AddAxis(const Axis& axis);
  void KeepEachOnce(Axis& axis);
  void KeepOneIfEqual(std::vector<Axis>& drawn);
  void Multiply(std::size_t by);
  void AddProduct(std::vector<Axis> sets);
  void AddRows(std::vector<Axis> sets, const std::string& option);
  void KeepEachRowOnce(std::vector<Axis>& sets, std::size_t rows, const std::string& option);
  void AddTrials(std::size_t sets);
  void AddTrialsOfRows(std::size_t sets);
  bool IsOfSeeds(const Axis& axis) const { return has_seeds_ && &axis == &axes_.back(); }

  std::vector<std::string> keys_;
  std::vector<Axis> axes_;  // of keys_
  bool has_seeds_ = false;  // the last axis is that of --seeds
  std::vector<std::string> varied_;
  std::vector<std::string> notes_;
  std::size_t size_ = 1;
  std::vector<TrialPlace> trials_;
  bool is_zipped_ = false;          // keys change together
  std::size_t rows_ = 1;            // that --zip or a table gives
  std::size_t row_stride_ = 1;      // the row changes after so many runs
  std::string table_ = {};          // name of the table that the rows are from
  std::vector<std::size_t> lines_;  // of the rows in the table; empty: there is none
};

/// Whether `key` is `table` itself, or a key or list element in it.
bool IsInside(std::string_view key, std::string_view table);
/// Whether --set takes a value of PlainValue() for one value: it is no range, has no commas outside of brackets and
/// quotes, and these are closed.
bool IsOneValue(const std::string& value);

}  // namespace mascot
