#include "orchestrator/sweeping/cluster/shard.h"

#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <string_view>

#include "base/number.h"
#include "experiment/toml/section.h"
#include "orchestrator/sweeping/table/table.h"
#include "system/environment.h"

namespace mascot {
namespace {

constexpr std::size_t kMaxShards = 1'000'000;

/// The number in an environment variable of Slurm. Throws ConfigError if it is none.
std::optional<std::size_t> Variable(const char* name) {
  const std::string text = EnvironmentText(name);
  if (text.empty()) return std::nullopt;
  if (const auto number = NumberFrom<std::size_t>(text)) return number;
  throw ConfigError({fmt::format("{}: expected a number, as Slurm sets it, got '{}'", name, text)});
}

std::filesystem::path Numbered(const std::filesystem::path& table, const std::string& number, std::size_t of) {
  return FileBeside(table, fmt::format(".{}-of-{}{}", number, of, table.extension() == ".csv" ? ".csv" : ""));
}

}  // namespace

std::string Shard::Text() const { return fmt::format("{}/{}", number, of); }

Shard ParseShard(const std::string& option, const std::string& text) {
  const auto slash = std::min(text.find('/'), text.size());
  const std::size_t number = NumberFrom<std::size_t>(std::string_view(text).substr(0, slash)).value_or(0);
  const std::size_t of =
      NumberFrom<std::size_t>(std::string_view(text).substr(std::min(slash + 1, text.size()))).value_or(0);
  if (number < 1 || number > of || of > kMaxShards)
    throw ConfigError({fmt::format("{}: expected I/N with 1 <= I <= N <= {}, got '{}'", option, kMaxShards, text)});
  return {number, of};
}

std::optional<Shard> ShardOfThisTask() {
  const auto id = Variable("SLURM_ARRAY_TASK_ID"), count = Variable("SLURM_ARRAY_TASK_COUNT");
  if (!id) return std::nullopt;
  const std::size_t first = Variable("SLURM_ARRAY_TASK_MIN").value_or(1);
  const std::size_t last = Variable("SLURM_ARRAY_TASK_MAX").value_or(first + count.value_or(0) - 1);
  if (!count || last - first + 1 != *count || *id < first || *id > last)
    throw ConfigError(
        {"--shard: expected I/N, because the tasks of this job array are not numbered one after another"});
  return Shard{*id - first + 1, *count};
}

std::filesystem::path TableOfShard(const std::filesystem::path& table, const Shard& shard) {
  return Numbered(table, std::to_string(shard.number), shard.of);
}

std::filesystem::path TablesOfShards(const std::filesystem::path& table, std::size_t of) {
  return Numbered(table, "*", of);
}

std::optional<std::filesystem::path> TableOfAll(const std::filesystem::path& shard) {
  static const std::regex kName(R"((.+)\.[0-9]+-of-[0-9]+(\.csv)?)");
  std::smatch parts;
  const std::string name = shard.filename();
  if (!std::regex_match(name, parts, kName)) return std::nullopt;
  return shard.parent_path() / (parts[1].str() + parts[2].str());
}

}  // namespace mascot
