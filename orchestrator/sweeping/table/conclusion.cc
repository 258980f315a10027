#include "orchestrator/sweeping/table/conclusion.h"

#include <filesystem>
#include <span>

#include "orchestrator/formats/whole_file.h"
#include "orchestrator/sweeping/plan/run_laws.h"
#include "orchestrator/sweeping/table/metrics.h"
#include "orchestrator/sweeping/table/outcomes.h"

namespace mascot {

std::vector<std::string> Conclude(const SweepPlan& plan, const SweepIdentity& identity, const SweepFile& table,
                                  const std::string& out) {
  const std::vector<std::string> metrics = identity.Metrics();
  const SweepLaws laws(plan, identity.laws);
  Outcomes outcomes(plan, laws, SweepColumns(plan, metrics));
  table.ForEachRow([&](const SweepFile::Cells& cells) { outcomes.Add(cells); });
  const std::filesystem::path path = StatisticsBeside(out);
  WholeFile statistics(path.string());
  outcomes.WriteStatistics(std::span(metrics).first(metrics.size() - kWallClockColumns),
                           [&](std::string_view line) { statistics.Write(line); });
  statistics.Commit();
  std::vector<std::string> lines = outcomes.Lines();
  lines.push_back("statistics over seeds: " + path.string());
  return lines;
}

}  // namespace mascot
