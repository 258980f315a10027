// `orchestrator up --view`: the real programs, watched by an independent client.

#include <gmock/gmock.h>

#include "tests/orchestrator.h"
#include "tests/web_client.h"

namespace mascot::test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

const char* const kRun = R"(
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

/// Where a run can be watched, as it says.
std::string UrlOf(const Running& up) {
  std::string url;
  EXPECT_TRUE(Until([&] {
    const std::string err = up.err();
    const auto at = err.find("http://");
    const auto end = at == std::string::npos ? at : err.find('\n', at);
    if (end != std::string::npos) url = err.substr(at, end - at);
    return !url.empty() || up.IsOver();
  }));
  return url;
}

Ran WsCheck(const std::string& url) {
  return Shell("node '" MASCOT_SOURCE_DIR "/tests/wscheck/wscheck.mjs' ws" + url.substr(4));
}

TEST(UpWithView, IsReadByFoxglovesOwnPackagesOverDds) {
  const ScratchFolder folder;
  WriteFile(folder.File("run.toml"), kRun);
  Up up(folder, "run", folder.File("run.toml"), {"--view", "127.0.0.1:0"});
  const std::string url = UrlOf(up);
  ASSERT_THAT(url, StartsWith("http://127.0.0.1:")) << up.err();
  const Ran check = WsCheck(url);
  EXPECT_EQ(check.exit_code, 0) << check.output;
  const nlohmann::json report = nlohmann::json::parse(check.output);
  EXPECT_EQ(report["channels"]["/ui/experiment"]["last"]["engine"], "dds");
  EXPECT_EQ(report["channels"]["/ui/frame"]["last"]["pace"], 1);
  EXPECT_EQ(report["answers"]["ask"],
            (nlohmann::json{{"granted", false}, {"words", "this run cannot be changed while it goes on"}}));
  WebClient page(url);
  EXPECT_THAT(page.Get("/"), HasSubstr("Content-Type: text/html; charset=utf-8"));
  WebClient watching(url);
  watching.Upgrade();
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130) << up.err();
  EXPECT_TRUE(watching.IsClosed());
  EXPECT_THAT(WebClient(url).Get("/"), "");  // nobody listens any more
}

TEST(UpWithView, TakesTheNextPortIfAnotherRunHasTheFirst) {
  const ScratchFolder folder;
  WriteFile(folder.File("run.toml"), kRun);
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

TEST(UpWithView, SaysWhatAnAddressIs) {
  const ScratchFolder folder;
  for (const char* address : {"127.0.0.1:x", "127.0.0.1:99999", "[::1", "a b", "run.toml"}) {
    Up up(folder, "run", Config("leaderless"), {std::string("--view=") + address});
    EXPECT_EQ(up.Wait(), 2);
    EXPECT_THAT(up.err(), HasSubstr(std::string("--view: expected ADDRESS:PORT (such as 127.0.0.1:8765), got \"") +
                                    address + "\""));
  }
  Up up(folder, "run", Config("leaderless"), {"--view", "203.0.113.1"});
  EXPECT_EQ(up.Wait(), 2);
  EXPECT_EQ(up.err(), "error: --view: cannot listen on 203.0.113.1:8765: Cannot assign requested address\n");
  EXPECT_FALSE(std::filesystem::exists(up.path()));
}

}  // namespace
}  // namespace mascot::test
