// The events.csv beside a recording, as viewers get it.

#include <gmock/gmock.h>

#include "orchestrator/formats/csv.h"
#include "orchestrator/live/recorded/incident_table.h"
#include "tests/support/scratch.h"
#include "tests/support/strict_csv.h"

namespace mascot {
namespace {

const std::vector<std::string> kNames = {"t_s", "until_s", "what", "count", "agent", "with", "detail"};

TEST(EventsCsv, OfManyLinesIsCutBetweenRowsAndNeverInsideACell) {
  const std::string law = "law = { text = '''\nif a:\n  b, \"c\"\n''' }";
  for (int shift = 0; shift < 60; ++shift) {  // so that the cut meets each byte of a row
    std::vector<std::vector<std::string>> rows = {kNames,
                                                  {"0", "0", "event", "1", "", "event 1", std::string(shift, 'x')}};
    std::string table = CsvRow(rows[0]) + CsvRow(rows[1]);
    for (int event = 2; table.size() < 140'000; ++event) {
      rows.push_back({"0.5", "0.5", "event", "1", "", "event " + std::to_string(event), law});
      table += CsvRow(rows.back());
    }
    const ScratchFolder folder;
    WriteFile(folder.File("events.csv"), table);
    const auto shown = StrictCsv(FirstIncidentsBeside(folder.File("run.mcap")));
    ASSERT_GT(shown.size(), rows.size() / 2);
    ASSERT_LT(shown.size(), rows.size());
    rows.resize(shown.size());
    ASSERT_EQ(shown, rows) << shift;
  }
}

TEST(EventsCsv, SaysWhichEventsWereGivenByHandAlsoWithALineBreakAtTheEndOfACell) {
  for (const char* end : {"", "\n"}) {  // a cell of an earlier version ends in one
    const ScratchFolder folder;
    WriteFile(folder.File("events.csv"),
              CsvRow(kNames) + CsvRow(std::vector<std::string>{"0", "0", "event", "1", "", "event 1 by hand",
                                                               "set = { \"law.beta\" = 2.0 }" + std::string(end)}));
    std::vector<ShownEvent> events = {{.number = 1, .tick = 0, .toml = "set = { \"law.beta\" = 2.0 }\n"}};
    MarkManualEvents(folder.File("run.mcap"), Experiment(), events);
    EXPECT_EQ(events[0].by_hand, std::optional(true));
  }
}

}  // namespace
}  // namespace mascot
