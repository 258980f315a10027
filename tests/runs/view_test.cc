// `orchestrator up --view` and `orchestrator view`: the real programs, watched by an independent client.

#include <gmock/gmock.h>

#include "bus/addresses.h"
#include "tests/orchestrator/live/shown/viewer.h"
#include "tests/support/folders.h"
#include "tests/support/orchestrator.h"
#include "tests/support/repeated.h"

namespace mascot::test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

const char* const kRecordedRun = R"(
[run]
duration_s = 1000.0
mode = "realtime"
[agents]
count = 3
[graph]
topology = "ring"
[law]
name = "consensus"
)";

/// The address at which a run can be watched, as `up` prints it.
std::string UrlOf(const Running& up) { return "http://" + RestOfLine(up, "http://"); }

/// Waits until a program has said this in words on stderr.
bool Says(const Running& program, const std::string& words) {
  return Until([&] { return program.Said(words) || program.IsOver(); }) && program.Said(words);
}

Ran WsCheck(const std::string& url) {
  return Shell("node '" + SourceFolder() + "/tests/wscheck/wscheck.mjs' ws" + url.substr(4));
}

/// Records 5 s of three agents.
std::string Record(const ScratchFolder& folder) {
  WriteFile(folder.File("run.toml"), kRecordedRun);
  Up up(folder, "run", folder.File("run.toml"),
        {"--engine", "inprocess", "--set", "run.mode='lockstep'", "--duration-s", "5", "--set",
         "output.save_data=false"});
  EXPECT_EQ(up.Wait(), 0) << up.err();
  return up.path() / "run.mcap";
}

/// `orchestrator view`, on any free port.
class ViewOf : public Running {
 public:
  ViewOf(const ScratchFolder& folder, const std::string& run, const std::string& at = "127.0.0.1:0")
      : Running(BuildFolder() + "/orchestrator", {"view", run, "--at", at}, folder.File("view")) {}
};

TEST(UpWithView, IsReadByFoxglovesOwnPackagesOverDds) {
  const ScratchFolder folder;
  WriteFile(folder.File("run.toml"), kRecordedRun);
  Up up(folder, "run", folder.File("run.toml"), {"--view", "127.0.0.1:0"});
  const std::string url = UrlOf(up);
  ASSERT_THAT(url, StartsWith("http://127.0.0.1:")) << up.err();
  const Ran check = WsCheck(url);
  EXPECT_EQ(check.exit_code, 0) << check.output;
  const nlohmann::json report = nlohmann::json::parse(check.output);
  EXPECT_EQ(report["channels"]["/ui/experiment"]["last"]["engine"], "dds");
  EXPECT_EQ(report["channels"]["/ui/frame"]["last"]["pace"], 1);
  EXPECT_EQ(report["answers"]["ask"],
            (nlohmann::json{{"granted", false},
                            {"words", "pace: expected a run in lockstep, got one in real time (run.speed)"}}));
  WebClient page(url);
  EXPECT_THAT(page.Get("/"), HasSubstr("Content-Type: text/html; charset=utf-8"));
  WebClient watching(url);
  watching.Upgrade();
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130) << up.err();
  EXPECT_TRUE(watching.IsClosed());
  EXPECT_THAT(WebClient(url).Get("/"), "");  // no process listens any more
}

TEST(UpWithView, BecomesTheRecordingAtTheSameAddressIfItShallStay) {
  const ScratchFolder folder;
  WriteFile(folder.File("run.toml"), kRecordedRun);
  Up up(folder, "run", folder.File("run.toml"),
        {"--view", "127.0.0.1:0", "--stay", "--watch-only", "--engine", "inprocess", "--duration-s", "0.2", "--set",
         "run.mode='lockstep'", "--set", "output.save_plot=true"});
  const std::string url = UrlOf(up);
  ASSERT_THAT(url, StartsWith("http://127.0.0.1:")) << up.err();
  const std::string token = RestOfLine(up, "#steer=");
  ASSERT_TRUE(Says(up, "the recording is shown until Ctrl-C\nview           " + url)) << up.err();
  ASSERT_TRUE(Until([&] { return WebClient(url).Get("/results/summary.json").starts_with("HTTP/1.1 200"); }));
  EXPECT_THAT(WebClient(url).Get("/results/paths.png"), StartsWith("HTTP/1.1 200"));
  Viewer viewer(url);
  viewer.Subscribe("/ui/experiment");
  const nlohmann::json shown = viewer.NextJsonOf("/ui/experiment");
  EXPECT_EQ(shown["source"], "recording");
  EXPECT_EQ(shown["recorded"]["has_summary"], true);
  EXPECT_THAT(shown["recorded"]["pictures"], testing::Contains("paths.png"));
  EXPECT_EQ(up.Summary()["exit"], 0);
  EXPECT_EQ(token.size(), 32u);
  EXPECT_TRUE(Until([&] { return CountOf("#steer=" + token, up.err()) == 2; })) << "the token stays " << up.err();
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 0) << "the exit code is that of the run";
}

TEST(UpWithView, EndsWithTheRunElsewhere) {
  const ScratchFolder folder;
  WriteFile(folder.File("run.toml"), kRecordedRun);
  Up up(folder, "run", folder.File("run.toml"),
        {"--view", "127.0.0.1:0", "--engine", "inprocess", "--duration-s", "0.2", "--set", "run.mode='lockstep'"});
  WebClient watching(UrlOf(up));
  watching.Upgrade();
  EXPECT_EQ(up.Wait(), 0) << "there is no terminal";
}

TEST(UpWithView, RefusesMetricsWithoutItAndMistakesInThem) {
  const ScratchFolder folder;
  WriteFile(folder.File("wrong.py"), "METRICS = ['nobody']\n");
  const std::string up = "'" + BuildFolder() + "/orchestrator' up " + Config("leaderless") + " --metric ";
  const Ran alone = Shell(up + folder.File("wrong.py"));
  EXPECT_EQ(alone.exit_code, 2);
  EXPECT_THAT(alone.output,
              HasSubstr("error: --metric: expected --view with it (a sweep has own metrics in its table)\n"));
  const Ran missing = Shell(up + folder.File("no.py") + " --view 127.0.0.1:0");
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.output, HasSubstr("error: --metric: " + folder.File("no.py") + ": cannot be read"));
  const Ran wrong = Shell(up + folder.File("wrong.py") + " --view 127.0.0.1:0");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.output,
              HasSubstr("error: --metric: wrong.py:1: METRICS: expected names of functions, got 'nobody'"));
}

TEST(UpWithView, RefusesToStayWithoutIt) {
  const Ran run = Shell("'" + BuildFolder() + "/orchestrator' up " + Config("leaderless") + " --stay");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.output, HasSubstr("error: --stay: expected --view with it\n"));
}

TEST(UpWithView, TakesTheNextPortIfAnotherRunHasTheFirst) {
  const ScratchFolder folder;
  WriteFile(folder.File("run.toml"), kRecordedRun);
  const std::vector<std::string> in_one_process = {"--engine",     "inprocess", "--set", "run.mode='lockstep'",
                                                   "--duration-s", "100000",    "--set", "output.save_data=false"};
  auto more = in_one_process;
  more.insert(more.end(), {"--view", "127.0.0.1:0"});
  Up first(folder, "first", folder.File("run.toml"), more);
  const std::string first_url = UrlOf(first);
  ASSERT_FALSE(first_url.empty());
  more.back() = first_url.substr(first_url.find("//") + 2);
  Up second(folder, "second", folder.File("run.toml"), more);
  const std::string second_url = UrlOf(second);
  EXPECT_NE(second_url, first_url);
  WebClient viewer(second_url);
  EXPECT_THAT(viewer.Upgrade(), StartsWith("HTTP/1.1 101"));
  EXPECT_TRUE(viewer.NextWith("\"op\":\"serverInfo\""));
  for (Up* up : {&first, &second}) up->Signal(SIGINT);
  for (Up* up : {&first, &second}) EXPECT_EQ(up->Wait(), 130);
}

TEST(UpWithView, OutlivesAMessageOfManyLevels) {
  const ScratchFolder folder;
  WriteFile(folder.File("run.toml"), kRecordedRun);
  Up up(folder, "run", folder.File("run.toml"),
        {"--engine", "inprocess", "--set", "run.mode='lockstep'", "--view", "127.0.0.1:0"});
  const std::string url = UrlOf(up);
  const std::string lists = Repeated(400'000, "[") + Repeated(400'000, "]");
  const std::string call = "\x02" + std::string("\0\0\0\0\1\0\0\0\4\0\0\0json", 16);
  const std::pair<int, std::string> kAttacks[] = {
      {WebClient::kText, lists},
      {WebClient::kText, R"({"op":"setParameters","parameters":[{"name":"law.p_gain","value":)" + lists + "}]}"},
      {WebClient::kBinary, call + R"({"ask":)" + lists + "}"},
      {WebClient::kBinary, call + R"({"ask":"event","toml":"set = { law.p_gain = )" + lists + R"( }"})"},
      {WebClient::kBinary, call + R"({"ask":"event","toml":"set = { a)" + Repeated(200'000, ".") + R"(a = 1 }"})"}};
  for (const auto& [opcode, message] : kAttacks) {
    Viewer viewer(url);
    viewer.Send(opcode, message);
    if (opcode == WebClient::kText)
      EXPECT_TRUE(viewer.IsClosed());
    else
      EXPECT_TRUE(viewer.Next());
    EXPECT_EQ(Viewer(url).Ask({{"ask", "pace"}, {"value", 2.0}})["granted"], true) << up.err();
  }
  EXPECT_TRUE(Says(up, ": dropped: expected a JSON object with \"op\"\n"));
  EXPECT_EQ(Viewer(url).Ask({{"ask", "stop"}})["granted"], true);
  EXPECT_EQ(up.Wait(), 0) << up.err();
  EXPECT_EQ(up.Summary()["exit"], 0);
  EXPECT_THAT(up.File("logs/viewers.log"), HasSubstr(": dropped: expected a JSON object with \"op\"\n"));
}

TEST(UpWithView, SaysWhomItRefusesAlsoInItsLogAndLetsInWhoIsAllowed) {
  const ScratchFolder folder;
  WriteFile(folder.File("run.toml"), kRecordedRun);
  Up up(folder, "run", folder.File("run.toml"),
        {"--engine", "inprocess", "--set", "run.mode='lockstep'", "--view", "127.0.0.1:0", "--allow-origin",
         "http://localhost:8080", "--allow-origin", "HTTPS://app.foxglove.dev"});
  const std::string url = UrlOf(up);
  const auto upgrade = [&](const std::string& origin) {
    return WebClient(url).Upgrade("foxglove.sdk.v1", "Origin: " + origin + "\r\n").substr(0, 12);
  };
  EXPECT_EQ(upgrade("http://localhost:8080"), "HTTP/1.1 101");
  EXPECT_EQ(upgrade("https://app.foxglove.dev"), "HTTP/1.1 101");
  EXPECT_EQ(upgrade("https://evil.example"), "HTTP/1.1 403");
  const std::string line =
      ": refused: a page of https://evil.example (--allow-origin https://evil.example lets it in)\n";
  EXPECT_TRUE(Says(up, line)) << up.err();
  EXPECT_TRUE(Until([&] { return up.File("logs/viewers.log").find(line) != std::string::npos; }));
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130);
}

TEST(UpWithView, SaysOnceThatTheLogOfViewersCannotBeWritten) {
  const ScratchFolder folder;
  WriteFile(folder.File("run.toml"), kRecordedRun);
  Up up(folder, "run", folder.File("run.toml"),
        {"--engine", "inprocess", "--set", "run.mode='lockstep'", "--set", "run.pace=1.0", "--view", "127.0.0.1:0"});
  const std::string url = UrlOf(up);
  EXPECT_TRUE(Until([&] { return std::filesystem::exists(up.path() / "logs"); }));
  std::filesystem::create_directories(up.path() / "logs/viewers.log");
  for (const char* page : {"https://evil.example", "https://worse.example"}) {
    WebClient(url).Upgrade("foxglove.sdk.v1", std::string("Origin: ") + page + "\r\n");
    EXPECT_TRUE(Says(up, std::string(": refused: a page of ") + page)) << up.err();
  }
  const std::string warning =
      "warning: cannot write " + (up.path() / "logs/viewers.log").string() + ": Is a directory\n";
  EXPECT_TRUE(Says(up, warning)) << up.err();
  EXPECT_EQ(up.err().find(warning), up.err().rfind(warning));
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130);
}

TEST(UpWithView, SaysWhatAnOriginIs) {
  const ScratchFolder folder;
  Up wrong(folder, "run", Config("leaderless"), {"--view", "--allow-origin", "app.foxglove.dev"});
  EXPECT_EQ(wrong.Wait(), 2);
  EXPECT_THAT(wrong.err(), HasSubstr("--allow-origin: expected the origin of a page, such as https://app.foxglove.dev, "
                                     "or file://, got 'app.foxglove.dev'"));
  Up alone(folder, "run", Config("leaderless"), {"--allow-origin", "https://app.foxglove.dev"});
  EXPECT_EQ(alone.Wait(), 2);
  EXPECT_EQ(alone.err(), "error: --allow-origin: expected --view with it\n");
}

TEST(UpWithView, LetsOthersWatchOnlyAndSaysWhereToSteer) {
  const ScratchFolder folder;
  WriteFile(folder.File("run.toml"), kRecordedRun);
  Up up(folder, "run", folder.File("run.toml"),
        {"--engine", "inprocess", "--set", "run.mode='lockstep'", "--view", "127.0.0.1:0", "--watch-only"});
  const std::string url = UrlOf(up), steer = RestOfLine(up, "steer          " + url + "/#steer=");
  EXPECT_THAT(up.err(), HasSubstr("view           " + url + "\n"));
  {
    Viewer watches(url), steers(url, "/?steer=" + steer);
    EXPECT_EQ(watches.Ask({{"ask", "stop"}})["words"], "this view only watches");
    EXPECT_EQ(steers.Ask({{"ask", "stop"}})["granted"], true);
  }
  EXPECT_EQ(up.Wait(), 0);
  Up alone(folder, "alone", Config("leaderless"), {"--watch-only"});
  EXPECT_EQ(alone.Wait(), 2);
  EXPECT_EQ(alone.err(), "error: --watch-only: expected --view with it\n");
}

TEST(UpWithView, AtAllAddressesNamesThoseThatOthersMayType) {
  const std::vector<std::string> addresses = AddressesForOthers();
  const ScratchFolder folder;
  WriteFile(folder.File("run.toml"), kRecordedRun);
  Up up(folder, "run", folder.File("run.toml"),
        {"--engine", "inprocess", "--set", "run.mode='lockstep'", "--view", "0.0.0.0:0"});
  const std::string first = addresses.empty() ? "0.0.0.0" : addresses.front();
  EXPECT_TRUE(Says(up, "view           http://" + first + ":")) << up.err();
  EXPECT_THAT(up.err(), testing::Not(HasSubstr("█"))) << "a QR code is for terminals";
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130);
}

TEST(UpWithView, SaysWhatAnAddressIs) {
  const ScratchFolder folder;
  for (const char* address : {"127.0.0.1:x", "127.0.0.1:99999", "[::1", "a b", "run.toml"}) {
    Up up(folder, "run", Config("leaderless"), {std::string("--view=") + address});
    EXPECT_EQ(up.Wait(), 2);
    EXPECT_THAT(up.err(), HasSubstr(std::string("--view: expected ADDRESS:PORT (such as 127.0.0.1:8765), got \"") +
                                    address + "\""));
  }
  Up port(folder, "run", Config("leaderless"), {"--view", "9000"});
  EXPECT_EQ(port.Wait(), 2);
  EXPECT_THAT(port.err(), HasSubstr("got \"9000\" (a port alone is :9000)"));
  Up up(folder, "run", Config("leaderless"), {"--view", "203.0.113.1"});
  EXPECT_EQ(up.Wait(), 2);
  EXPECT_EQ(up.err(), "error: --view: cannot listen on 203.0.113.1:8765: Cannot assign requested address\n");
  EXPECT_FALSE(std::filesystem::exists(up.path()));
}

TEST(View, PlaysARecordingWhereverAViewerWantsItUntilCtrlC) {
  const ScratchFolder folder;
  ViewOf view(folder, Record(folder));
  const std::string url = UrlOf(view);
  ASSERT_THAT(url, StartsWith("http://127.0.0.1:")) << view.err();
  Viewer viewer(url);
  viewer.Subscribe("/ui/experiment");
  const nlohmann::json experiment = viewer.NextJsonOf("/ui/experiment");
  EXPECT_EQ(experiment["source"], "recording");
  EXPECT_EQ(experiment["recorded"]["end_s"], 5.0);
  EXPECT_EQ(experiment["recorded"]["run"], folder.File("run")) << "as `replay` takes it";
  EXPECT_EQ(experiment["recorded"]["loss"], "");
  EXPECT_EQ(experiment["recorded"]["incidents"], ReadFile(folder.File("run/events.csv")));
  viewer.Subscribe("/ui/frame");
  EXPECT_EQ(viewer.FrameAt(0)["state"], "paused");
  const auto granted = [](const char* words) { return nlohmann::json{{"granted", true}, {"words", words}}; };
  EXPECT_EQ(viewer.Ask({{"ask", "seek"}, {"t_s", 2.5}}), granted("at tick 250 (2.5 s)"));
  const nlohmann::json there = viewer.FrameAt(250);
  EXPECT_EQ(viewer.Ask({{"ask", "seek"}, {"t_s", 1.0}}), granted("at tick 100 (1 s)"));
  viewer.FrameAt(100);
  EXPECT_EQ(viewer.Ask({{"ask", "event"}, {"toml", "cut = [[1, 2]]"}}),
            (nlohmann::json{{"granted", false}, {"words", "a recording cannot be changed"}}));
  viewer.Ask({{"ask", "pace"}, {"value", 100}});
  viewer.Ask({{"ask", "resume"}});
  EXPECT_EQ(viewer.FrameAt(500)["state"], "paused");
  viewer.Ask({{"ask", "seek"}, {"t_s", 2.5}});  // the end is not the end
  EXPECT_EQ(viewer.FrameAt(250)["p"], there["p"]);
  viewer.Ask({{"ask", "pace"}, {"value", 0.1}});
  viewer.Ask({{"ask", "resume"}});
  const Ran check = WsCheck(url);  // which sets the pace to 1
  EXPECT_EQ(check.exit_code, 0) << check.output;
  view.Signal(SIGINT);
  EXPECT_EQ(view.Wait(), 130) << view.err();
}

TEST(View, TellsEventsByHandFromThoseOfTheFileByTheTableBesideTheRecording) {
  const ScratchFolder folder;
  WriteFile(folder.File("run.toml"), std::string(kRecordedRun) + "[[events]]\nat_s = 0.0\ncut = [[1, 2]]\n");
  Up up(folder, "run", folder.File("run.toml"),
        {"--engine", "inprocess", "--set", "run.mode='lockstep'", "--set", "run.pace=1.0"});
  const auto send = [&](const std::string& words) {
    return Shell("'" + BuildFolder() + "/orchestrator' send --run '" + up.path().string() + "' " + words + " 2>&1");
  };
  EXPECT_TRUE(Until([&] { return up.IsOver() || send("pause").exit_code == 0; })) << up.err();
  EXPECT_THAT(send("event 'set = { \"link.loss\" = 0.5 }\n'").output, StartsWith("takes effect at "));
  EXPECT_THAT(send("set law.p_gain=2").output, StartsWith("takes effect at "));
  send("step 2");
  send("stop");
  EXPECT_EQ(up.Wait(), 0) << up.err();

  const auto by_hand = [&] {
    ViewOf view(folder, up.path());
    Viewer viewer(UrlOf(view));
    viewer.Subscribe("/ui/events");
    nlohmann::json said;
    for (const nlohmann::json& event : viewer.NextJsonOf("/ui/events")) said.push_back(event["by_hand"]);
    return said.dump();
  };
  EXPECT_EQ(by_hand(), "[false,true,true]");
  std::string table = up.File("events.csv");
  table.replace(table.find("law.p_gain"), 10, "law.v_gain");
  WriteFile(up.path() / "events.csv", table);
  EXPECT_EQ(by_hand(), "[false,true,null]") << "another text: that of another run";
  WriteFile(up.path() / "events.csv", "t_s\n\"\"\"");
  EXPECT_EQ(by_hand(), "[null,null,null]");
  std::filesystem::remove(up.path() / "events.csv");
  EXPECT_EQ(by_hand(), "[null,null,null]");
}

TEST(View, PlaysACutRecordingUpToTheCutAndSaysThatItIsCut) {
  const ScratchFolder folder;
  const std::string whole = ReadFile(Record(folder));
  WriteFile(folder.File("cut.mcap"), whole.substr(0, whole.size() / 2));
  ViewOf view(folder, folder.File("cut.mcap"));
  Viewer viewer(UrlOf(view));
  EXPECT_THAT(view.err(), HasSubstr("warning: " + folder.File("cut.mcap") + ": the file ends"));
  viewer.Subscribe("/ui/experiment");
  const nlohmann::json recorded = viewer.NextJsonOf("/ui/experiment")["recorded"];
  EXPECT_THAT(recorded["loss"].get<std::string>(), StartsWith("the file ends"));
  EXPECT_GT(recorded["end_s"], 0);
  EXPECT_LT(recorded["end_s"], 5);
  EXPECT_THAT(viewer.Ask({{"ask", "seek"}, {"t_s", 4.9}})["words"].get<std::string>(),
              HasSubstr(", where the recording ends"));
}

TEST(View, SaysWhomItRefusesAndLetsInWhoIsAllowed) {
  const ScratchFolder folder;
  const std::string recording = Record(folder);
  const auto upgrade = [&](const Running& view, const std::string& origin) {
    return WebClient(UrlOf(view)).Upgrade("foxglove.sdk.v1", "Origin: " + origin + "\r\n").substr(0, 12);
  };
  ViewOf strict(folder, recording);
  EXPECT_EQ(upgrade(strict, "http://localhost:8080"), "HTTP/1.1 403");
  EXPECT_TRUE(
      Says(strict, ": refused: a page of http://localhost:8080 (--allow-origin http://localhost:8080 lets it in)\n"))
      << strict.err();
  Running open(BuildFolder() + "/orchestrator",
               {"view", recording, "--at", "127.0.0.1:0", "--allow-origin", "http://localhost:8080"},
               folder.File("open"));
  EXPECT_EQ(upgrade(open, "http://localhost:8080"), "HTTP/1.1 101");
  EXPECT_EQ(upgrade(open, "null"), "HTTP/1.1 403");
}

TEST(View, SaysWhatItCannotServe) {
  const ScratchFolder folder;
  ViewOf none(folder, folder.File("none"));
  EXPECT_EQ(none.Wait(), 2);
  EXPECT_EQ(none.err(), "error: cannot open " + folder.File("none") + ": No such file or directory\n");
  ViewOf nowhere(folder, folder.File("none"), "127.0.0.1:x");
  EXPECT_EQ(nowhere.Wait(), 2);
  EXPECT_THAT(nowhere.err(), HasSubstr("--at: expected ADDRESS:PORT (such as 127.0.0.1:8765), got \"127.0.0.1:x\""));
  ViewOf elsewhere(folder, Record(folder), "203.0.113.1");
  EXPECT_EQ(elsewhere.Wait(), 2);
  EXPECT_EQ(elsewhere.err(), "error: --at: cannot listen on 203.0.113.1:8765: Cannot assign requested address\n");
}

}  // namespace
}  // namespace mascot::test
