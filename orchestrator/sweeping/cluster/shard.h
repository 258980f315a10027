#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace mascot {

/// A share of the runs of a sweep: those whose number, counted from 0, is number - 1 modulo `of`. All shares together
/// are the sweep, and equally long to within one run.
struct Shard {
  std::size_t number = 1;  ///< 1..of
  std::size_t of = 1;

  bool Has(std::size_t run) const { return run % of == number - 1; }
  /// How many of `runs` it has.
  std::size_t CountOf(std::size_t runs) const { return runs / of + (runs % of >= number ? 1 : 0); }
  std::string Text() const;  ///< "3/10"
};

/// The share that "I/N" names. Throws ConfigError, naming `option`.
Shard ParseShard(const std::string& option, const std::string& text);
/// The share of this task of a Slurm job array, by its environment; nothing if this is none.
std::optional<Shard> ShardOfThisTask();
/// The table of a share: sweep.3-of-10.csv of sweep.csv.
std::filesystem::path TableOfShard(const std::filesystem::path& table, const Shard& shard);
/// What the tables of all shares of `of` are called, for a shell: sweep.*-of-10.csv.
std::filesystem::path TablesOfShards(const std::filesystem::path& table, std::size_t of);
/// The table whose share has this table: sweep.csv of sweep.3-of-10.csv; nothing if it is not called so.
std::optional<std::filesystem::path> TableOfAll(const std::filesystem::path& shard);

}  // namespace mascot
