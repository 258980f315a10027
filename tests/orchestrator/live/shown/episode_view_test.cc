// Episodes as viewers see them: on one page, one after the other, and waiting for them.
#include "orchestrator/live/shown/episode_view.h"

#include <gmock/gmock.h>

#include <atomic>
#include <mutex>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>

#include "tests/orchestrator/live/shown/viewer.h"
#include "tests/support/waits.h"

namespace mascot::test {
namespace {

using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;
using Json = nlohmann::json;

constexpr const char* kPair = R"(
[run]
name = "pair"
duration_s = 1000.0
[agents]
count = 2
position_m = [[0, 0, 1], [0, 3, 1]]
model = "double_integrator"
[graph]
topology = "complete"
[law]
name = "actions"
)";

/// Episodes of 1000 s on a page.
class Shown : public testing::Test {
 protected:
  Shown() { episodes.SetWitnesses({&view}); }
  ~Shown() override { episodes.Finish(); }  // while the view is there

  EpisodeView::Options OptionsWith(double pace) {
    return {.at = {.port = 0},
            .pace = pace,
            .may_wait = [this] { return may_wait.load(); },
            .log =
                [this](const std::string& line) {
                  const std::lock_guard lock(mutex);
                  log += line + "\n";
                }};
  }
  void StepTo(std::int64_t tick) {
    const Deadline deadline("tick " + std::to_string(tick));
    while (episodes.tick() < tick && !episodes.is_over()) episodes.Step();
  }
  /// Steps in a thread of its own, until the episode is over or the test is.
  std::jthread Stepping() {
    return std::jthread([this](const std::stop_token& is_over) {
      const std::stop_callback go_on(is_over, [this] { may_wait = false; });
      while (!episodes.is_over() && !is_over.stop_requested()) episodes.Step();
    });
  }

  std::mutex mutex;
  std::string log;
  std::atomic<bool> may_wait = true;
  Episodes episodes{kPair, "pair.toml", {}};
  EpisodeView view{episodes.experiment(), OptionsWith(1)};
};

TEST_F(Shown, APageIsThereBeforeTheFirstStepAndStaysAtIt) {
  Viewer viewer(view.url());
  viewer.Subscribe("/ui/frame");
  StepTo(5);
  viewer.FrameAt(4);  // tick 5 has no row before the next step
  EXPECT_THAT(log, IsEmpty());
}

TEST_F(Shown, AnEpisodeThatIsOverStaysUntilTheNextWhichIsAtTheSameAddress) {
  const std::string url = view.url();
  StepTo(2);
  episodes.Finish();
  {
    Viewer viewer(url);
    viewer.Subscribe("/ui/frame");
    viewer.NextWhere("/ui/frame", "the end", [](const auto& frame) { return frame["state"] == "done"; });
    EXPECT_EQ(viewer.Ask({{"ask", "pause"}}), (Json{{"granted", false}, {"words", "the run is over"}}));
  }
  episodes.Reset({{.key = "run.name", .value = "'second'"}});
  StepTo(3);
  EXPECT_EQ(view.url(), url);
  Viewer viewer(url);
  viewer.Subscribe("/ui/experiment");
  EXPECT_EQ(viewer.NextJsonOf("/ui/experiment")["name"], "second");
  viewer.Subscribe("/ui/frame");
  viewer.FrameAt(2);
}

TEST_F(Shown, ViewersPauseItAndWhoStepsWaits) {
  Viewer viewer(view.url());
  viewer.Subscribe("/ui/frame");
  StepTo(1);
  const std::jthread stepping = Stepping();
  EXPECT_EQ(viewer.Ask({{"ask", "pause"}})["granted"], true);
  const auto is_paused = [](const Json& frame) { return frame["state"] == "paused"; };
  const auto tick = viewer.NextWhere("/ui/frame", "a pause", is_paused)["tick"].get<std::int64_t>();
  EXPECT_EQ(viewer.Ask({{"ask", "step"}, {"count", 2}})["granted"], true);
  viewer.FrameAt(tick + 2);
  EXPECT_EQ(viewer.Ask({{"ask", "step"}, {"count", 1}})["granted"], true);
  viewer.FrameAt(tick + 3);  // and not a tick further in between
}

TEST_F(Shown, TheirEventsAreThoseOfTheEpisode) {
  Viewer viewer(view.url());
  viewer.Subscribe("/ui/events");
  StepTo(1);
  {
    const std::jthread stepping = Stepping();
    EXPECT_EQ(viewer.Ask({{"ask", "event"}, {"toml", "cut = [[1, 2]]"}})["granted"], true);
    viewer.NextWhere("/ui/events", "the event",
                     [](const Json& events) { return events.dump().find("cut") != std::string::npos; });
    EXPECT_EQ(viewer.Ask({{"ask", "event"}, {"toml", "cut = [[2, 9]]"}})["granted"], false);
  }
  EXPECT_THAT(episodes.Save().events, ElementsAre(Field(&Episodes::Snapshot::GivenEvent::toml, "cut = [[1, 2]]\n")));
}

TEST_F(Shown, AStopEndsItInOrder) {
  Viewer viewer(view.url());
  StepTo(1);
  std::jthread stepping = Stepping();
  EXPECT_EQ(viewer.Ask({{"ask", "stop"}})["granted"], true);
  const Deadline deadline("the end of the episode");
  stepping.join();
  EXPECT_TRUE(episodes.is_over());
  EXPECT_EQ(episodes.failure(), "");
}

TEST_F(Shown, ThePaceThatViewersSetHoldsForTheNextEpisode) {
  {
    Viewer viewer(view.url());
    StepTo(1);
    const std::jthread stepping = Stepping();
    EXPECT_EQ(viewer.Ask({{"ask", "pace"}, {"value", 0.5}})["granted"], true);
  }
  episodes.Reset({});
  may_wait = true;
  StepTo(1);
  Viewer viewer(view.url());
  viewer.Subscribe("/ui/frame");
  EXPECT_EQ(viewer.FrameAt(0)["pace"], 0.5);
}

TEST_F(Shown, ARestoredEpisodeIsNotWaitedFor) {
  StepTo(3);
  Episodes::Snapshot snapshot = episodes.Save();
  snapshot.changes = {{.key = "run.pace", .value = "1e-6"}};  // 10000 s a tick
  const Deadline deadline("a restored episode");
  episodes.Restore(snapshot, [] {});
  EXPECT_EQ(episodes.tick(), 3);
  EXPECT_TRUE(may_wait);
}

TEST_F(Shown, APortThatIsTakenIsNotTaken) {
  EXPECT_NE(EpisodeView(episodes.experiment(), OptionsWith(1)).url(), view.url());
}

TEST_F(Shown, WhatCannotBeIsSaid) {
  EXPECT_THAT([&] { const EpisodeView wrong(episodes.experiment(), OptionsWith(-1)); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("pace: expected a number in ")));
  EpisodeView::Options elsewhere = OptionsWith(1);
  elsewhere.at.address = "192.0.2.1";
  EXPECT_THAT([&] { const EpisodeView wrong(episodes.experiment(), elsewhere); },
              ThrowsMessage<ConfigError>(HasSubstr("at: ")));
}

}  // namespace
}  // namespace mascot::test
