// What the events.csv beside a recording tells of the events in it.
#include "orchestrator/live/recorded/incident_table.h"

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "tests/support/scratch.h"

namespace mascot {
namespace {

using testing::ElementsAre;
using testing::Optional;

/// Whether events 1 to 4, which took effect at 0.01 to 0.04 s, were given by hand, according to `table`; nothing: it
/// does not say.
std::vector<std::optional<bool>> ByHand(const std::string& table) {
  const ScratchFolder folder;
  WriteFile(folder.File("events.csv"), "t_s,until_s,what,count,agent,with,detail\n" + table);
  Experiment experiment;
  experiment.control.rate_hz = 100;
  std::vector<ShownEvent> events;
  for (const int number : {1, 2, 3, 4}) events.push_back({.number = number, .tick = number, .toml = "cut = []"});
  MarkManualEvents(folder.File("run.mcap"), experiment, events);
  std::vector<std::optional<bool>> by_hand;
  for (const ShownEvent& event : events) by_hand.push_back(event.by_hand);
  return by_hand;
}

TEST(IncidentTable, TellsOfTheOtherEventsAlthoughOneIsMissing) {
  EXPECT_THAT(ByHand("0.01,0.01,event,1,,event 1,cut = []\n"
                     "0.03,0.03,event,1,,event 3 by hand,cut = []\n"
                     "0.04,0.04,event,1,,event 4,cut = []\n"),
              ElementsAre(Optional(false), std::nullopt, Optional(true), Optional(false)));
}

TEST(IncidentTable, TellsOfEventsInAnyOrder) {
  EXPECT_THAT(ByHand("0.04,0.04,event,1,,event 4,cut = []\n"
                     "0.02,0.02,event,1,,event 2 by hand,cut = []\n"),
              ElementsAre(std::nullopt, Optional(true), std::nullopt, Optional(false)));
}

TEST(IncidentTable, TellsNothingOfWhatIsNoEventOfTheRecording) {
  EXPECT_THAT(ByHand("0.01,0.01,event,1,,event 99,cut = []\n"
                     "0.01,0.01,event,1,,event -1,cut = []\n"
                     "0.01,0.01,event,1,,event,cut = []\n"
                     "0.01,0.01,event,1,,event 1x by hand,cut = []\n"
                     "0.01,0.01,contact,1,,event 1 by hand,cut = []\n"
                     "0.02,0.02,event,1,,event 1 by hand,cut = []\n"
                     "0.01,0.01,event,1,,event 1 by hand,\"cut = [[1, 2]]\"\n"
                     "event 1 by hand\n\"\"\"\n"),
              ElementsAre(std::nullopt, std::nullopt, std::nullopt, std::nullopt));
}

}  // namespace
}  // namespace mascot
