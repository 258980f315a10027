// RunSocket and RunsAlive: which users reach a run on this machine, what the run answers, and which processes are taken
// for runs.
#include "orchestrator/control/run_socket.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>
#include <functional>
#include <future>
#include <nlohmann/json.hpp>

#include "agent/laws/laws.h"
#include "orchestrator/control/running_runs.h"
#include "tests/support/repeated.h"
#include "tests/support/three_agents.h"
#include "tests/support/waits.h"

namespace mascot {
namespace {

using test::AwaitEndOf;
using test::AwaitInput;
using test::Until;
using ::testing::HasSubstr;
using Voice = RunningRun::Voice;

constexpr uid_t kNobody = 65534;

std::string RunNameOf(pid_t process) { return std::string(kRunSocketPrefix) + std::to_string(process); }

/// What RunsAlive() says of a process; process 0: nothing.
RunningRun ListedAs(pid_t process) {
  for (const RunningRun& run : RunsAlive())
    if (run.process == process) return run;
  return {};
}

/// Whether `condition` holds in a process of another user.
bool HoldsForNobody(const std::function<bool()>& condition) {
  const pid_t child = fork();
  if (child == 0) _exit(setgid(kNobody) == 0 && setuid(kNobody) == 0 && condition() ? 0 : 1);
  const int status = AwaitEndOf(child, "the process of another user");
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/// A run of this process, which has not begun.
class RunSocketTest : public testing::Test {
 protected:
  RunSocketTest()
      : experiment_(Load(Three("name = 'consensus'\n"))),
        requests_(experiment_, 0),
        socket_(experiment_, "/some/folder", "inprocess", "http://127.0.0.1:8765", requests_) {}

  const Experiment experiment_;
  RunRequests requests_;
  const RunSocket socket_;
};

/// Another process, which listens under a name and calls `act` with each connection.
class Listener {
 public:
  using Act = std::function<void(const Descriptor& client)>;

  /// `name`: gives the name of the socket for the process id.
  Listener(const std::function<std::string(pid_t)>& name, const Act& act, uid_t user = geteuid()) {
    int ready[2];
    if (pipe(ready) != 0) return;
    pid_ = fork();
    if (pid_ == 0) {
      if (user != geteuid() && (setgid(user) != 0 || setuid(user) != 0)) _exit(1);
      const Descriptor socket = MakeLocalSocket(SOCK_CLOEXEC);
      if (!ListenAs(name(getpid()), socket)) _exit(1);
      close(ready[0]);
      close(ready[1]);
      for (;;) act(Descriptor(accept4(socket.number(), nullptr, nullptr, SOCK_CLOEXEC)));
    }
    close(ready[1]);
    AwaitInput(ready[0], "a process that listens");  // or has ended: then no process has the other end of the pipe
    close(ready[0]);
  }
  ~Listener() {
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    AwaitEndOf(pid_, "the process that listened");
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  pid_t pid() const { return pid_; }

 private:
  pid_t pid_ = 0;
};

void ReadOneLine(const Descriptor& client) {
  for (char byte = 0; byte != '\n';)
    if (read(client.number(), &byte, 1) <= 0) return;
}

Listener::Act AnswersWith(const std::string& text) {
  return [text](const Descriptor& client) {
    ReadOneLine(client);
    if (write(client.number(), text.data(), text.size()) < 0) _exit(1);
  };
}

TEST_F(RunSocketTest, TellsWhatRunItIs) {
  const RunningRun run = ListedAs(getpid());
  EXPECT_EQ(run.voice, Voice::kAnswers);
  EXPECT_EQ(run.name, "test");
  EXPECT_EQ(run.folder, "/some/folder");
  EXPECT_EQ(run.engine, "inprocess");
  EXPECT_EQ(run.page, "http://127.0.0.1:8765");
  EXPECT_EQ(run.agents, 3);
  EXPECT_EQ(run.domain, -1);
  EXPECT_EQ(run.tick, -1);
  EXPECT_EQ(run.duration_s, 1);
  const nlohmann::json json = nlohmann::json::parse(RunsJson({run}));
  EXPECT_EQ(json[0]["process"], getpid());
  EXPECT_EQ(json[0]["domain"], nullptr);
  EXPECT_EQ(json[0]["tick"], nullptr);
}

TEST_F(RunSocketTest, PassesRequestsOnAndAnswersBack) {
  requests_.Close();
  EXPECT_EQ(AskRun(getpid(), {.kind = Request::Kind::kPause}), (Answer{false, "the run is over"}));
  EXPECT_EQ(AskRun(1, {.kind = Request::Kind::kPause}), (Answer{false, "the run ended before it answered"}));
}

TEST_F(RunSocketTest, WhoWaitsForAnAnswerKeepsNobodyElseWaiting) {
  auto answer = std::async(std::launch::async, [] { return AskRun(getpid(), {.kind = Request::Kind::kPause}); });
  EXPECT_EQ(ListedAs(getpid()).voice, Voice::kAnswers) << "the run has not begun, so that the request waits";
  requests_.Close();
  const test::Deadline deadline("an answer to the request");
  EXPECT_EQ(answer.get().words, "the run is over");
}

TEST_F(RunSocketTest, ListensToItsOwnUserAndRootOnly) {
  if (geteuid() != 0) GTEST_SKIP() << "needs root, to be another user";
  requests_.Close();
  const pid_t process = getpid();
  EXPECT_TRUE(HoldsForNobody([process] {
    const RunningRun run = ListedAs(process);
    return run.process == process && run.user == "root" && !run.is_ours();
  }));
  EXPECT_TRUE(HoldsForNobody([process] {
    const Answer answer = AskRun(process, {.kind = Request::Kind::kStop});
    return !answer.granted &&
           answer.words == "process " + std::to_string(process) + " is user root's, who alone may ask it";
  }));
}

TEST_F(RunSocketTest, ClosesTheConnectionOfAnotherUserBeforeItHasSaidAnything) {
  if (geteuid() != 0) GTEST_SKIP() << "needs root, to be another user";
  const pid_t process = getpid();
  EXPECT_TRUE(HoldsForNobody([process] {
    const Descriptor client = MakeLocalSocket(SOCK_CLOEXEC);
    char byte = 0;
    return ConnectTo(RunNameOf(process), client) && AwaitInput(client.number(), "the end of the connection") &&
           read(client.number(), &byte, 1) == 0;
  }));
}

TEST_F(RunSocketTest, DropsAClientThatSpeaksByTheByte) {
  const Descriptor client = MakeLocalSocket(SOCK_CLOEXEC);
  ASSERT_TRUE(ConnectTo(RunNameOf(getpid()), client));
  EXPECT_TRUE(Until([&client] { return send(client.number(), "{", 1, MSG_NOSIGNAL) < 0; }));
  EXPECT_EQ(ListedAs(getpid()).voice, Voice::kAnswers);
}

/// How often threads of this process have given up the processor by themselves, and the processor time they took.
std::int64_t Waits() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_nvcsw;
}

TEST_F(RunSocketTest, WaitsWhileTheProcessHasNoDescriptorLeft) {
  ASSERT_EQ(ListedAs(getpid()).voice, Voice::kAnswers);
  const Descriptor client = MakeLocalSocket(SOCK_CLOEXEC);
  const std::string question = "{\"who\": true}\n";
  rlimit limit{}, none{};
  getrlimit(RLIMIT_NOFILE, &limit);
  none = {0, limit.rlim_max};
  setrlimit(RLIMIT_NOFILE, &none);
  EXPECT_TRUE(ConnectTo(RunNameOf(getpid()), client));
  EXPECT_EQ(write(client.number(), question.data(), question.size()), std::ssize(question));
  // This thread does not sleep here: it is the other one that waits, again and again.
  const std::int64_t before = Waits();
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (Waits() < before + 5 && std::chrono::steady_clock::now() < deadline) {
  }
  EXPECT_GE(Waits(), before + 5) << "it tries again and again without a pause";
  setrlimit(RLIMIT_NOFILE, &limit);
  char byte = 0;
  EXPECT_TRUE(AwaitInput(client.number(), "an answer")) << "now it is let in";
  EXPECT_EQ(read(client.number(), &byte, 1), 1);
}

TEST_F(RunSocketTest, HasAnotherNameIfItsOwnIsTaken) {
  const RunRequests requests(experiment_, 0);
  RunRequests second_requests(experiment_, 0);
  const RunSocket second(experiment_, "/other/folder", "inprocess", "", second_requests);
  EXPECT_EQ(ListedAs(getpid()).voice, Voice::kAnswers);
}

TEST(RunsAlive, KnowsWhoIsStopped) {
  const Listener stopped(RunNameOf, [](const Descriptor&) { raise(SIGSTOP); });
  EXPECT_TRUE(Until([&] { return ListedAs(stopped.pid()).voice == Voice::kStopped; }));
  EXPECT_EQ(AskRun(stopped.pid(), {.kind = Request::Kind::kPause}),
            (Answer{false, "the run is stopped; `kill -CONT " + std::to_string(stopped.pid()) + "` lets it go on"}));
  EXPECT_EQ(nlohmann::json::parse(RunsJson({ListedAs(stopped.pid())}))[0]["state"], "stopped");
}

TEST(RunsAlive, KnowsWhoIsStoppedAndLetsNobodyInAnyMore) {
  const Listener stopped(RunNameOf, [](const Descriptor&) { raise(SIGSTOP); });
  std::vector<Descriptor> waiting;
  do {
    waiting.push_back(MakeLocalSocket(SOCK_CLOEXEC | SOCK_NONBLOCK));
  } while (ConnectTo(RunNameOf(stopped.pid()), waiting.back()) && waiting.size() < 900);
  EXPECT_EQ(ListedAs(stopped.pid()).voice, Voice::kStopped);
}

TEST(RunsAlive, DoesNotListWhoHasTheNameOfAnotherProcess) {
  const pid_t pid = getpid();
  const Listener impostor([pid](pid_t) { return RunNameOf(pid); }, AnswersWith("{}\n"));
  EXPECT_EQ(ListedAs(pid).process, 0);
  EXPECT_EQ(ListedAs(impostor.pid()).process, 0);
}

TEST(RunsAlive, DoesNotAskAProcessOfAnotherUser) {
  if (geteuid() != 0) GTEST_SKIP() << "needs root, to be another user";
  int told[2];
  ASSERT_EQ(pipe(told), 0);
  const Listener stranger(RunNameOf, [&told](const Descriptor& client) {
    char byte = 0;
    const char heard = read(client.number(), &byte, 1) > 0 ? 'h' : 'n';
    if (write(told[1], &heard, 1) != 1) _exit(1);
  });
  const pid_t pid = stranger.pid();
  EXPECT_TRUE(HoldsForNobody(
      [pid] { return !ListedAs(pid).is_ours() && !AskRun(pid, {.kind = Request::Kind::kStop}).granted; }));
  char heard[2] = {};
  for (char& each : heard) {
    ASSERT_TRUE(AwaitInput(told[0], "what the stranger has heard"));
    EXPECT_EQ(read(told[0], &each, 1), 1);
  }
  EXPECT_EQ(std::string_view(heard, 2), "nn") << "it was told something";
  close(told[0]);
  close(told[1]);
}

TEST(RunsAlive, EvenForRootAProgramOfAnotherUserIsNoRunByItsName) {
  if (geteuid() != 0) GTEST_SKIP() << "needs root, to be another user";
  constexpr const char* kImpostor = R"(
import os, socket
server = socket.socket(socket.AF_UNIX)
server.bind(f"\0mascot-run-{os.getpid()}")
server.listen()
while True:
    server.accept()[0].send(b'{"granted": true, "words": "trust me"}\n')
)";
  const pid_t pid = fork();
  if (pid == 0) {
    if (setgid(kNobody) == 0 && setuid(kNobody) == 0)
      execl("/usr/bin/python3", "python3", "-I", "-c", kImpostor, nullptr);
    _exit(1);
  }
  const std::string words = "process " + std::to_string(pid) + " is user nobody's, who alone may ask it";
  EXPECT_TRUE(Until([&] { return AskRun(pid, {.kind = Request::Kind::kPause}).words == words; }));
  EXPECT_EQ(ListedAs(pid).process, 0);
  kill(pid, SIGKILL);
  AwaitEndOf(pid, "the impostor");
}

TEST(RunsAlive, DoesNotListWhoAnswersOtherThanARun) {
  const std::string good =
      R"({"name":"a","folder":"/f","engine":"dds","page":"","agents":3,"domain":4,"tick":1,"t_s":0.1,"duration_s":1,)"
      R"("paused":false,"pace":0,"vehicles":""})";
  const auto listed = [](const std::string& answer) {
    const Listener listener(RunNameOf, AnswersWith(answer));
    return ListedAs(listener.pid());
  };
  const auto with = [&good](const std::string& field, const std::string& value) {
    std::string text = good;
    const auto begin = text.find('"' + field + "\":") + field.size() + 3;
    return text.replace(begin, text.find_first_of(",}", begin) - begin, value) + "\n";
  };
  EXPECT_EQ(listed(good + "\n").name, "a");
  EXPECT_EQ(listed(with("folder", R"("/f\u001b[2J")")).folder, "/f\\u001b[2J") << "no terminal obeys it";
  for (const std::string& answer : {std::string("{}\n"),
                                    std::string("nonsense\n"),
                                    std::string("[1]\n"),
                                    std::string("\n"),
                                    std::string(""),
                                    std::string("{\"name\": \"\xff\"}\n"),
                                    std::string(200'000, '[') + "\n",
                                    "{\"name\": " + Repeated(500'000, "[") + "\n",
                                    with("agents", "0"),
                                    with("agents", "1e400"),
                                    with("agents", "-1"),
                                    with("agents", "2.5"),
                                    with("agents", "18446744073709551615"),
                                    with("name", "7"),
                                    with("name", '"' + std::string(5000, 'x') + '"'),
                                    with("domain", "233"),
                                    with("tick", "\"1\""),
                                    with("tick", "9223372036854775808"),
                                    with("t_s", "-1"),
                                    with("t_s", "null"),
                                    with("duration_s", "[1]"),
                                    with("paused", "1"),
                                    with("pace", "{}"),
                                    std::string(2 << 20, 'x')}) {
    SCOPED_TRACE(answer.substr(0, 200));
    EXPECT_EQ(listed(answer).process, 0);
  }
}

TEST(RunsAlive, AnAnswerToARequestIsOneOrIsNotBelieved) {
  const auto answer = [](const std::string& text) {
    const Listener listener(RunNameOf, AnswersWith(text));
    return AskRun(listener.pid(), {.kind = Request::Kind::kPause});
  };
  EXPECT_EQ(answer("{\"granted\": true, \"words\": \"so be it\"}\n"), (Answer{true, "so be it"}));
  EXPECT_EQ(answer("{\"granted\": true, \"words\": \"a\\nb\\u009b\"}\n"), (Answer{true, "a\nb\\u009b"}));
  for (const char* text : {"{\"granted\": 1, \"words\": \"\"}\n", "{\"granted\": true}\n", "{}\n",
                           "{\"granted\": true, \"words\": [[]]}\n"})
    EXPECT_EQ(answer(text), (Answer{false, "the answer is none that a run gives"})) << text;
  EXPECT_EQ(answer("{\"granted\": true, \"wo"), (Answer{false, "the run ended before it answered"}));
}

}  // namespace
}  // namespace mascot
