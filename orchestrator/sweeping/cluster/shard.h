#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace mascot {

/// A share of the runs of a sweep: those whose number, counted from 0, is number - 1 modulo `of`. All shares together
/// are the sweep; their numbers of runs differ by at most one.
struct Shard {
  std::size_t number = 1;  ///< 1..of
  std::size_t of = 1;

  bool Has(std::size_t run) const { return run % of == number - 1; }
  /// How many of the runs 0 .. runs - 1 the share has.
  std::size_t CountOf(std::size_t runs) const { return runs / of + (runs % of >= number ? 1 : 0); }
  std::string Text() const;  ///< "3/10"
};

/// The share that `text`, "I/N", names. Throws ConfigError, naming `option`, unless 1 <= I <= N <= 1000000.
Shard ParseShard(const std::string& option, const std::string& text);
/// The share of this process as a task of a Slurm job array, by its environment; nothing: it is no such task. Throws
/// ConfigError if the tasks are not numbered one after another.
std::optional<Shard> ShardOfThisTask();
/// Path of the table of a share: sweep.3-of-10.csv for sweep.csv.
std::filesystem::path TableOfShard(const std::filesystem::path& table, const Shard& shard);
/// Pattern for a shell that fits the tables of all `of` shares: sweep.*-of-10.csv for sweep.csv.
std::filesystem::path TablesOfShards(const std::filesystem::path& table, std::size_t of);
/// Path of the whole table, from that of the table of a share: sweep.csv for sweep.3-of-10.csv; nothing if `shard` has
/// no such name.
std::optional<std::filesystem::path> TableOfAll(const std::filesystem::path& shard);

}  // namespace mascot
