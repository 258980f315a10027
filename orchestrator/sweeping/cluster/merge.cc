#include "orchestrator/sweeping/cluster/merge.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "experiment/toml/section.h"
#include "orchestrator/sweeping/cluster/shard.h"
#include "orchestrator/sweeping/table/conclusion.h"
#include "orchestrator/sweeping/table/table.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kNamedRuns = 5;  // of those that are missing

/// Throws ConfigError if two tables are not of the same sweep.
void CheckSame(const SweepIdentity& first, const fs::path& first_table, const SweepIdentity& other,
               const fs::path& table) {
  if (other.build != first.build)
    throw ConfigError({fmt::format("sweep merge: expected shares by one build, got {} ({}) and {} ({})", first.build,
                                   first_table.string(), other.build, table.string())});
  if (other.Text() == first.Text()) return;
  if (const std::string difference = other.DifferenceFrom(first.Text()); !difference.empty())
    throw ConfigError(
        {fmt::format("sweep merge: expected shares of one sweep, got {} (there) and {} (here), which differ "
                     "in {}",
                     first_table.string(), table.string(), difference)});
}

/// Throws ConfigError if runs are missing, naming the first.
void CheckComplete(const RowPlaces& there, std::size_t runs) {
  if (there.size() == runs) return;
  std::string missing;
  std::size_t named = 0;
  for (std::size_t run = 0; run < runs && named < kNamedRuns; ++run) {
    if (there.Has(run)) continue;
    missing += (named == 0 ? "" : ", ") + std::to_string(run);
    ++named;
  }
  const std::size_t more = runs - there.size() - named;
  throw ConfigError(
      {fmt::format("sweep merge: expected every one of the {} runs, got none of {}{} (the command of a "
                   "share flies what it lacks)",
                   runs, missing, more > 0 ? fmt::format(" and {} more", more) : "")});
}

/// A table of a share.
struct ShareTable {
  fs::path path;
  TableRows rows;
};

}  // namespace

SweepIdentity IdentityOf(const fs::path& table) {
  if (auto identity = SweepIdentity::FromText(PlanBeside(table))) return *identity;
  throw ConfigError(
      {fmt::format("sweep merge: expected tables of shares, each with its .plan beside it, got {}", table.string())});
}

std::vector<fs::path> TablesNamed(const std::string& word) {
  const fs::path folder = fs::path(word).has_parent_path() ? fs::path(word).parent_path() : ".";
  std::vector<fs::path> tables;
  if (fs::is_directory(folder))
    for (const auto& entry : fs::directory_iterator(folder)) {
      const auto all = TableOfAll(entry.path().filename());
      if (all && *all == fs::path(word).filename())
        tables.push_back(fs::path(word).parent_path() / entry.path().filename());
    }
  std::ranges::sort(tables);
  if (tables.empty() && fs::exists(word)) return {word};
  if (tables.empty())
    throw ConfigError(
        {fmt::format("sweep merge: expected the table of a share, or of shares called {}, got {}, which is "
                     "not there",
                     TablesOfShards(word, 2).string(), word)});
  return tables;
}

fs::path MergedTable(const std::vector<fs::path>& tables) {
  const auto name = [](const fs::path& table) { return TableOfAll(table).value_or(fs::path()); };
  const fs::path all = name(tables.front());
  if (all.empty() || std::ranges::any_of(tables, [&](const fs::path& table) { return name(table) != all; }))
    throw ConfigError({"sweep merge: expected --out FILE, because these tables are not called as shares of one table"});
  return all;
}

Merged Merge(const std::vector<fs::path>& tables, const std::string& out, bool force) {
  const SweepIdentity identity = IdentityOf(tables.front());
  const SweepPlan plan(identity.words);
  const std::vector<std::string> columns = SweepColumns(plan, identity.Metrics());
  std::vector<std::unique_ptr<ShareTable>> shares;
  RowPlaces share_of;  // of each run: the place of its share in `shares`, from 1 on
  for (const fs::path& table : tables) {
    CheckSame(identity, tables.front(), IdentityOf(table), table);
    if (fs::exists(out) && fs::equivalent(out, table))
      throw ConfigError({fmt::format("sweep merge: expected --out FILE that is none of the shares, got {}", out)});
    shares.push_back(std::make_unique<ShareTable>(ShareTable{table, TableRows(table, columns, /*lost=*/false, &plan)}));
    shares.back()->rows.places().ForEach([&](std::size_t run, std::uint64_t /*place*/) {
      if (run >= plan.size())
        throw ConfigError(
            {fmt::format("sweep merge: expected runs below {}, got run {} in {}", plan.size(), run, table.string())});
      if (!share_of.Add(run, shares.size()))
        throw ConfigError({fmt::format("sweep merge: expected each run in one table, got run {} in {} and in {}", run,
                                       shares[share_of.At(run) - 1]->path.string(), table.string())});
    });
  }
  CheckComplete(share_of, plan.size());
  SweepFile all(out, columns, identity.Text(), force,
                [&](const std::string& theirs) { return identity.DifferenceFrom(theirs); });
  for (const auto& share : shares)
    share->rows.ForEach([&](std::size_t run, const std::string& line) {
      if (!all.Has(run)) all.AddLine(run, line);
    });
  all.Sort();
  return {.runs = plan.size(), .lines = Conclude(plan, identity, all, out)};
}

}  // namespace mascot
