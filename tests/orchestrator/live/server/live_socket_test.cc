// HTTP and WebSocket of the live view, as strangers, slow and broken clients use them.

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <vector>

#include "experiment/toml/section.h"
#include "orchestrator/live/server/origin.h"
#include "orchestrator/live/server/outgoing.h"
#include "orchestrator/live/server/pages.h"
#include "orchestrator/live/server/socket.h"
#include "system/local_socket.h"
#include "tests/orchestrator/live/server/web_client.h"
#include "tests/support/orchestrator.h"

namespace mascot::test {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::Not;
using ::testing::StartsWith;

/// Sends every message back, but drops the client for "bad"; sends a text to all clients each period.
class Echo final : public SocketUser {
 public:
  explicit Echo(SocketOptions options = {}, std::size_t told_bytes = 0)
      : told_(std::make_shared<const std::string>(told_bytes, 'x')) {
    WriteFile(folder_.File("index.html"), "<p>here</p>");
    WriteFile(folder_.File("secret.txt"), "not a file of a page");
    WriteFile(folder_.File(".hidden.html"), "hidden");
    options.port = 0;
    options.subprotocols = {"foxglove.sdk.v1", "foxglove.websocket.v1"};
    options.period = std::chrono::milliseconds(1);
    owned_ = std::make_unique<SocketServer>(options, *this, [this](const std::string& line) {
      const std::lock_guard lock(mutex_);
      log_ += line + "\n";
    });
    server_ = owned_.get();
    server_->Start();
  }
  HttpAnswer Get(std::string_view target) override { return Pages(folder_.path()).Get(target); }
  void OnOpen(ClientId client, const std::string& subprotocol, std::string_view /*target*/) override {
    ++open;
    clients_.push_back(client);
    server_->Send(client,
                  {.is_text = true, .head = "hello ", .body = std::make_shared<const std::string>(subprotocol)});
  }
  std::string OnMessage(ClientId client, bool is_text, std::span<const std::uint8_t> message) override {
    const std::string text(message.begin(), message.end());
    if (text == "throw") throw std::runtime_error("broken");
    if (text == "bad") return "it is bad";
    server_->Send(client, {.is_text = is_text, .head = text});
    return {};
  }
  void OnClose(ClientId client) override {
    --open;
    std::erase(clients_, client);
  }
  void OnTimer() override {
    ++periods;
    if (breaks) throw std::runtime_error("made up");
    if (told_->empty()) return;
    for (const ClientId client : clients_) server_->Send(client, {.body = told_});
  }

  SocketServer& server() { return *server_; }
  std::string url() const { return server_->url(); }
  void End() { owned_.reset(); }
  std::string log() {
    const std::lock_guard lock(mutex_);
    return log_;
  }
  std::atomic<bool> breaks = false;
  std::atomic<int> open = 0;
  std::atomic<std::int64_t> periods = 0;

 private:
  ScratchFolder folder_;
  std::shared_ptr<const std::string> told_;
  std::vector<ClientId> clients_;
  std::mutex mutex_;
  std::string log_;
  SocketServer* server_ = nullptr;  // for its own thread, up to its end
  std::unique_ptr<SocketServer> owned_;
};

/// Whether a request with these headers may talk to a server that was asked to listen at `asked`.
bool MayTalk(const std::string& asked, const std::vector<std::string_view>& hosts,
             const std::vector<std::string_view>& origins = {}, const std::string& allowed = "",
             std::string_view target = "/") {
  std::vector<std::string> let_in;
  if (!allowed.empty()) let_in.push_back(ReadAllowedOrigin(allowed));
  return !OriginCheck(asked, asked, let_in).Judge({.hosts = hosts, .origins = origins, .target = target});
}

std::string NameOfThisMachine() {
  char name[256] = "";
  gethostname(name, sizeof name - 1);
  return name;
}

TEST(Origin, OnlyThisMachineAndTheAddressAskedForAreOurHost) {
  for (const char* host : {"127.0.0.1:8765", "127.0.0.1", "127.255.0.3:1", "localhost:9999", "LOCALHOST",
                           "LocalHost:80", "[::1]:8765", "[::1]", "[0:0:0:0:0:0:0:1]:65535"})
    EXPECT_TRUE(MayTalk("127.0.0.1", {host})) << host;
  for (const char* host : {"",
                           ":",
                           ":8765",
                           "evil.example",
                           "evil.example:8765",
                           "localhost.evil.example",
                           "127.0.0.1.evil.example",
                           "127.0.0.1@evil.example",
                           "evil.example@127.0.0.1",
                           "user:password@localhost",
                           "[::1",
                           "::1",
                           "[::1]]",
                           "[]",
                           "[",
                           "[::1]8765",
                           "[::1]:",
                           "[::1%lo]",
                           "[::1%25lo]:8765",
                           "[::ffff:127.0.0.1]:8765",
                           "[::127.0.0.1]",
                           "localhost.",
                           "127.0.0.1.",
                           "localhost:",
                           "localhost:0",
                           "localhost:65536",
                           "localhost:99999999999999999999",
                           "localhost:+1",
                           "localhost:-1",
                           "localhost:8765 ",
                           " localhost",
                           "localhost :8765",
                           "localhost:87 65",
                           "localhost\t",
                           "localhost:0x1",
                           "localhost:8765:8765",
                           "localhost/",
                           "localhost?",
                           "localhost#",
                           "localhost,localhost",
                           "localhost;",
                           "loc%61lhost",
                           "127.0.0.%31",
                           "127.1",
                           "127.0.1",
                           "0x7f.0.0.1",
                           "0x7f000001",
                           "2130706433",
                           "017700000001",
                           "127.0.0.01",
                           "0.0.0.0",
                           "0",
                           "192.168.1.11",
                           "10.0.0.1:80",
                           "[fe80::1]",
                           "*",
                           "localhost_",
                           "localhost:1; script-src * 'unsafe-inline'",
                           "localhost\r\nX: 1",
                           "\xff",
                           "l\u0585calhost"})
    EXPECT_FALSE(MayTalk("127.0.0.1", {host})) << host;
  EXPECT_FALSE(MayTalk("127.0.0.1", {std::string_view("localhost\0", 10)}));
  EXPECT_FALSE(MayTalk("127.0.0.1", {std::string(300, 'a')}));
  EXPECT_FALSE(MayTalk("127.0.0.1", {})) << "no Host";
  EXPECT_FALSE(MayTalk("127.0.0.1", {"localhost", "localhost"})) << "two";
}

TEST(Origin, WhoListensElsewhereIsAskedForByThatAddressOrName) {
  EXPECT_TRUE(MayTalk("192.168.1.11", {"192.168.1.11:8765"}));
  EXPECT_TRUE(MayTalk("192.168.1.11", {NameOfThisMachine()}));
  EXPECT_TRUE(MayTalk("Lab1", {"lab1:8765"}));
  EXPECT_TRUE(MayTalk("fe80::1", {"[FE80:0::1]:8765"}));
  EXPECT_TRUE(OriginCheck("lab1", "192.168.1.11", {}).Judge({{"192.168.1.12"}, {}, "/"}));
  EXPECT_FALSE(OriginCheck("lab1", "192.168.1.11", {}).Judge({{"192.168.1.11"}, {}, "/"}));
  EXPECT_FALSE(MayTalk("192.168.1.11", {"192.168.1.12"}));
  EXPECT_FALSE(MayTalk("192.168.1.11", {"evil.example"}));
  for (const char* all : {"0.0.0.0", "::", "[::]"}) {
    EXPECT_TRUE(MayTalk(all, {"192.168.1.11:8765"})) << all;
    EXPECT_TRUE(MayTalk(all, {"[2001:db8::1]:8765"})) << all;
    EXPECT_TRUE(MayTalk(all, {NameOfThisMachine()})) << all;
    EXPECT_FALSE(MayTalk(all, {"evil.example"})) << all;
    EXPECT_FALSE(MayTalk(all, {"0x7f.1"})) << all;
  }
}

TEST(Origin, OnlyPagesOfTheSameHostAndPortMayTalk) {
  const std::string_view host = "127.0.0.1:8765";
  EXPECT_TRUE(MayTalk("127.0.0.1", {host}, {}));
  for (const char* origin : {"http://127.0.0.1:8765", "https://127.0.0.1:8765", "HTTP://127.0.0.1:8765"})
    EXPECT_TRUE(MayTalk("127.0.0.1", {host}, {origin})) << origin;
  EXPECT_TRUE(MayTalk("127.0.0.1", {"localhost"}, {"http://localhost"}));
  EXPECT_TRUE(MayTalk("127.0.0.1", {"localhost"}, {"http://localhost:80"}));
  EXPECT_TRUE(MayTalk("127.0.0.1", {"LOCALHOST:443"}, {"https://localhost"}));
  EXPECT_TRUE(MayTalk("127.0.0.1", {"[::1]:8765"}, {"http://[::1]:8765"}));
  for (const char* origin : {"null",
                             "",
                             " ",
                             "http://evil.example",
                             "http://127.0.0.1",
                             "http://127.0.0.1:8766",
                             "http://localhost:8765",
                             "https://evil.example:8765",
                             "file://",
                             "file:///",
                             "file://127.0.0.1:8765",
                             "data://127.0.0.1:8765",
                             "data://x",
                             "data:text/html,x",
                             "blob://x",
                             "blob:http://127.0.0.1:8765",
                             "ftp://127.0.0.1:8765",
                             "ws://127.0.0.1:8765",
                             "app://foxglove",
                             "chrome-extension://abc",
                             "about:blank",
                             "javascript:0",
                             "//127.0.0.1:8765",
                             "127.0.0.1:8765",
                             "http:127.0.0.1:8765",
                             "http:/127.0.0.1:8765",
                             "http:///127.0.0.1:8765",
                             "http://127.0.0.1:8765/",
                             "http://127.0.0.1:8765/x",
                             "http://127.0.0.1:8765?x",
                             "http://127.0.0.1:8765#x",
                             "http://x@127.0.0.1:8765",
                             "http://127.0.0.1:8765@evil.example",
                             "http://127.0.0.1:8765.evil.example",
                             "http://127.0.0.1.:8765",
                             "http://127.0.0.1:08765x",
                             "http://127.0.0.1:",
                             " http://127.0.0.1:8765",
                             "http://127.0.0.1:8765 ",
                             "http://127.0.0.1:8765 http://127.0.0.1:8765",
                             "http://127.0.0.1:8765,null",
                             "http://127.0.0.%31:8765",
                             "http://[::ffff:127.0.0.1]:8765",
                             "http://[::1",
                             "http://*",
                             "*"})
    EXPECT_FALSE(MayTalk("127.0.0.1", {host}, {origin})) << origin;
  EXPECT_FALSE(MayTalk("127.0.0.1", {host}, {"http://127.0.0.1:8765", "http://evil.example"})) << "two";
  EXPECT_FALSE(MayTalk("127.0.0.1", {host}, {"http://127.0.0.1:8765", "http://127.0.0.1:8765"})) << "two";
  EXPECT_FALSE(MayTalk("127.0.0.1", {"evil.example"}, {"http://evil.example"})) << "DNS rebinding";
}

TEST(Origin, PagesOfAllowedOriginsMayTalkToo) {
  const std::string foxglove = "https://app.foxglove.dev";
  EXPECT_TRUE(MayTalk("127.0.0.1", {"localhost:8765"}, {foxglove}, foxglove));
  EXPECT_TRUE(MayTalk("127.0.0.1", {"localhost:8765"}, {foxglove}, "HTTPS://App.Foxglove.dev:443"));
  EXPECT_TRUE(MayTalk("127.0.0.1", {"localhost:8765"}, {"http://localhost:8080"}, "http://localhost:8080"));
  EXPECT_TRUE(MayTalk("127.0.0.1", {"localhost:8765"}, {"file://"}, "file://"));
  EXPECT_TRUE(MayTalk("127.0.0.1", {"localhost:8765"}, {"http://localhost:8765"}, foxglove)) << "and its own still may";
  for (const char* origin :
       {"http://app.foxglove.dev", "https://app.foxglove.dev:8443", "https://foxglove.dev",
        "https://evil.app.foxglove.dev", "https://app.foxglove.dev.evil.example", "file://", "null"})
    EXPECT_FALSE(MayTalk("127.0.0.1", {"localhost:8765"}, {origin}, foxglove)) << origin;
  EXPECT_FALSE(MayTalk("127.0.0.1", {"evil.example"}, {foxglove}, foxglove)) << "by another name of this machine";
}

TEST(Origin, WhatIsAllowedIsAnOriginAndNothingElse) {
  EXPECT_EQ(ReadAllowedOrigin("HTTP://LocalHost:80"), "http://localhost");
  EXPECT_EQ(ReadAllowedOrigin("https://[0::1]:8443"), "https://[::1]:8443");
  for (const char* text : {"", "*", "null", "app.foxglove.dev", "https://", "https://*.foxglove.dev", "https://a/",
                           "https://a b", "https://a:b", "ftp://a", "file:///", "https://a@b", "https://a,https://b"})
    EXPECT_THAT(
        [&] { ReadAllowedOrigin(text); },
        testing::ThrowsMessage<ConfigError>(
            "--allow-origin: expected the origin of a page, such as https://app.foxglove.dev, or file://, got '" +
            std::string(text) + "'"))
        << text;
  EXPECT_THAT([] { ReadAllowedOrigin("https://\x1b[31m\u202e"); },
              testing::ThrowsMessage<ConfigError>(EndsWith("got 'https://\\u001b[31m\\u202e'")));
}

TEST(Origin, RequestsThatNameNoPathAreRefused) {
  for (const char* target : {"http://evil.example/", "http://localhost/", "*", "localhost:80", "", "index.html", "?x"})
    EXPECT_FALSE(MayTalk("127.0.0.1", {"localhost"}, {}, "", target)) << target;
}

TEST(Origin, RefusalsSayWhoAndHowToLetThemIn) {
  const OriginCheck door("127.0.0.1", "127.0.0.1", {});
  const auto words = [&](std::string_view host, std::string_view origin) {
    const auto refusal = door.Judge({.hosts = {host}, .origins = {origin}, .target = "/"});
    return refusal ? refusal->words : "";
  };
  EXPECT_EQ(words("localhost:8765", "https://app.foxglove.dev"),
            "a page of https://app.foxglove.dev (--allow-origin https://app.foxglove.dev lets it in)");
  EXPECT_EQ(words("localhost:8765", "file://"), "a page of file:// (--allow-origin file:// lets it in)");
  EXPECT_EQ(words("localhost:8765", "null"), "a page of 'null', which is no address of a page");
  EXPECT_EQ(words("localhost:8765", "\x1b[2J\u202e\n"),
            "a page of '\\u001b[2J\\u202e\\n', which is no address of a page");
  EXPECT_EQ(words("evil.example\x7f", ""),
            "a request to 'evil.example\\u007f', which is not the address of this server");
  EXPECT_THAT(words(std::string(8000, 'x'), ""), HasSubstr("'" + std::string(100, 'x') + "...'"));
}

TEST(Origin, AFloodOfRefusalsIsNoFloodOfLines) {
  RefusalCount count;
  std::vector<std::string> lines;
  for (int i = 0; i < 100'000; ++i) {
    if (auto line = count.Line("a page of x")) lines.push_back(*line);
    if (auto line = count.Line("a page of " + std::to_string(i))) lines.push_back(*line);
  }
  EXPECT_EQ(lines.front(), "a page of x");
  EXPECT_THAT(lines, testing::Contains("a page of x, 10 times"));
  EXPECT_THAT(lines, testing::Contains("others, 10000 times"));
  EXPECT_LE(lines.size(), 40u);
}

TEST(LiveSocket, ServesFilesOfThePageAndNoOthers) {
  Echo echo;
  WebClient client(echo.url());
  const std::string page = client.Get("/");
  EXPECT_THAT(page, StartsWith("HTTP/1.1 200 OK"));
  EXPECT_THAT(page, EndsWith("\r\n\r\n<p>here</p>"));
  EXPECT_THAT(page, HasSubstr("Content-Type: text/html; charset=utf-8\r\n"));
  EXPECT_THAT(page, HasSubstr("default-src 'none'; script-src 'self';"));
  EXPECT_THAT(page, HasSubstr("connect-src 'self';"));
  EXPECT_THAT(page, Not(HasSubstr(client.host()))) << "nothing of a request is in the answer";
  EXPECT_EQ(client.Get("/index.html?x=1"), page);
  for (const char* path : {"/nothing.html", "/secret.txt", "/.hidden.html", "/../index.html", "/%2e%2e/index.html",
                           "//index.html", "/vendor/three/../../../../etc/passwd", "/vendor/nobody/x.js", "/vendor/"})
    EXPECT_THAT(WebClient(echo.url()).Get(path), StartsWith("HTTP/1.1 404")) << path;
  EXPECT_THAT(WebClient(echo.url()).Ask("POST / HTTP/1.1\r\nHost: localhost\r\n\r\n"), StartsWith("HTTP/1.1 405"));
}

TEST(Pages, ServesPicturesAndTheSummaryOfARunAndNothingElseOfItsFolder) {
  const ScratchFolder page, run;
  WriteFile(page.File("index.html"), "<p>here</p>");
  WriteFile(run.File("paths.png"), "a picture");
  WriteFile(run.File("summary.json"), "{}");
  WriteFile(run.File("config.toml"), "secret");
  WriteFile(run.File("other.json"), "secret");
  WriteFile(run.File(".hidden.png"), "secret");
  std::filesystem::create_directories(run.File("logs"));
  WriteFile(run.File("logs/inner.png"), "secret");
  std::filesystem::create_symlink("/etc/hostname", run.File("link.png"));
  const Pages pages(page.path(), run.path());
  EXPECT_EQ(pages.Get("/results/paths.png").body, "a picture");
  EXPECT_EQ(pages.Get("/results/summary.json").body, "{}");
  for (const char* path :
       {"/results/", "/results/config.toml", "/results/other.json", "/results/.hidden.png", "/results/logs/inner.png",
        "/results/../index.html", "/results/link.png", "/results/no.png", "/paths.png"})
    EXPECT_EQ(pages.Get(path).status, 404) << path;
  EXPECT_EQ(Pages(page.path()).Get("/results/paths.png").status, 404) << "a run that goes on has no results";
}

TEST(LiveSocket, RefusesAForeignHostAndAForeignOrigin) {
  Echo echo;
  const auto ask = [&](const std::string& host, const std::string& more) {
    return WebClient(echo.url()).Ask("GET / HTTP/1.1\r\nHost: " + host + "\r\n" + more + "\r\n");
  };
  EXPECT_THAT(ask("evil.example", ""), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(ask("[::1", ""), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(ask("localhost:1; script-src * 'unsafe-inline'", ""),
              AllOf(StartsWith("HTTP/1.1 403"), Not(HasSubstr("script-src"))));
  EXPECT_THAT(ask("localhost", "Host: localhost\r\n"), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(ask("localhost", "Origin: http://evil.example\r\n"),
              AllOf(StartsWith("HTTP/1.1 403"), Not(HasSubstr("evil.example"))));
  EXPECT_THAT(ask("localhost", "Origin: http://localhost\r\nOrigin: http://localhost\r\n"), StartsWith("HTTP/1.1 403"));
  for (const char* origin : {"http://evil.example", "null", "file://", "data://x", "blob://x", "ftp://localhost",
                             "http://localhost:8080", "https://app.foxglove.dev"})
    EXPECT_THAT(WebClient(echo.url()).Upgrade("foxglove.sdk.v1", "Origin: " + std::string(origin) + "\r\n"),
                StartsWith("HTTP/1.1 403"))
        << origin;
  for (const char* target : {"http://localhost/", "index.html", "*"})
    EXPECT_THAT(WebClient(echo.url()).Ask("GET " + std::string(target) + " HTTP/1.1\r\nHost: localhost\r\n\r\n"),
                StartsWith("HTTP/1.1 400"))
        << target;
  EXPECT_THAT(WebClient(echo.url()).Ask("GET / HTTP/1.0\r\n\r\n"), StartsWith("HTTP/1.0 400")) << "no Host";
  WebClient own(echo.url());
  EXPECT_THAT(own.Upgrade("foxglove.sdk.v1", "Origin: http://" + own.host() + "\r\n"), StartsWith("HTTP/1.1 101"));
}

TEST(LiveSocket, SaysWhomItRefusesAndLetsInWhoIsAllowed) {
  const std::string foxglove = "Origin: https://app.foxglove.dev\r\n";
  Echo strict;
  for (int i = 0; i < 12; ++i)
    EXPECT_THAT(WebClient(strict.url()).Upgrade("foxglove.sdk.v1", foxglove), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(strict.log(),
              MatchesRegex("viewer 127\\.0\\.0\\.1:[0-9]+: refused: a page of https://app\\.foxglove\\.dev "
                           "\\(--allow-origin https://app\\.foxglove\\.dev lets it in\\)\n"
                           "viewer [0-9.:]+: refused: .* lets it in\\), 10 times\n"));
  SocketOptions options;
  options.allowed_origins = {"https://app.foxglove.dev"};
  Echo open(options);
  EXPECT_THAT(WebClient(open.url()).Upgrade("foxglove.sdk.v1", foxglove), StartsWith("HTTP/1.1 101"));
  EXPECT_THAT(WebClient(open.url()).Upgrade("foxglove.sdk.v1", "Origin: https://evil.example\r\n"),
              StartsWith("HTTP/1.1 403"));
}

TEST(LiveSocket, AnErrorOfOursEndsTheServerAndNothingElse) {
  for (const bool by_timer : {true, false}) {
    Echo echo;
    WebClient client(echo.url()), visitor(echo.url());
    client.Upgrade();
    EXPECT_TRUE(client.NextWith("hello"));
    EXPECT_THAT(visitor.Get("/"), StartsWith("HTTP/1.1 200"));
    if (by_timer)
      echo.breaks = true;
    else
      echo.server().Fail("made up");
    EXPECT_TRUE(client.IsClosed());
    EXPECT_TRUE(visitor.IsClosed());
    EXPECT_TRUE(Until([&] { return !echo.log().empty(); }));
    EXPECT_EQ(echo.log(), "viewers: the view has ended because of an error of ours, and nothing else has: made up\n");
    EXPECT_TRUE(echo.server().has_failed());
    EXPECT_EQ(WebClient(echo.url()).Get("/"), "") << "the port is closed";
    echo.server().Post([] { FAIL() << "nobody is there to do it"; });
    echo.server().Fail("again");
  }
}

TEST(LiveSocket, TakesTheSubprotocolThatItKnows) {
  Echo echo;
  WebClient first(echo.url()), second(echo.url());
  EXPECT_THAT(first.Upgrade("chat, foxglove.websocket.v1"),
              HasSubstr("Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n"));
  EXPECT_EQ(first.Next()->payload, "hello foxglove.websocket.v1");
  EXPECT_THAT(second.Upgrade("chat"), StartsWith("HTTP/1.1 400"));
}

TEST(LiveSocket, TwentyClientsTalkAtOnceAndTooManyAreRefused) {
  SocketOptions options;
  options.limits.clients = 20;
  Echo echo(options);
  std::vector<std::unique_ptr<WebClient>> clients;
  for (int i = 0; i < 20; ++i) {
    clients.push_back(std::make_unique<WebClient>(echo.url()));
    EXPECT_THAT(clients.back()->Upgrade(), StartsWith("HTTP/1.1 101"));
  }
  for (int i = 0; i < 20; ++i) clients[i]->Send(WebClient::kText, std::to_string(i));
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(clients[i]->NextWith(std::to_string(i)));
  EXPECT_THAT(WebClient(echo.url()).Upgrade(), StartsWith("HTTP/1.1 503"));
  clients.pop_back();
  EXPECT_TRUE(Until([&] { return echo.open == 19; }));
  EXPECT_THAT(WebClient(echo.url()).Upgrade(), StartsWith("HTTP/1.1 101"));
}

TEST(LiveSocket, DropsClientsThatBreakTheRulesWithALineInTheLog) {
  Echo echo;
  const std::pair<std::string, const char*> kBroken[] = {
      {WebClient::FrameOf(WebClient::kText, "bad"), "dropped: it is bad\n"},
      {WebClient::FrameOf(WebClient::kText, "throw"), "dropped: an error of ours: broken\n"},
      {WebClient::FrameOf(3, "x"), "dropped: The WebSocket frame contained an illegal opcode\n"},
      {std::string("\x81\x05hello", 7), "dropped: The WebSocket frame was unmasked\n"},
      {WebClient::FrameOf(WebClient::kText, "\xff\xff"), "dropped: The WebSocket frame payload was not valid utf8\n"},
      {WebClient::FrameOf(WebClient::kBinary, std::string((1 << 20) + 1, 'x')),
       "dropped: The WebSocket message exceeded the locally configured limit\n"},
  };
  for (const auto& [bytes, line] : kBroken) {
    WebClient client(echo.url());
    client.Upgrade();
    client.SendRaw(bytes);
    client.Send(WebClient::kClose, "");
    EXPECT_TRUE(client.IsClosed()) << line;
    client.Close();
    EXPECT_TRUE(Until([&, text = line] { return echo.log().find(text) != std::string::npos; })) << echo.log();
  }
  WebClient noise(echo.url());
  noise.SendRaw(std::string(100'000, '\0'));
  EXPECT_TRUE(noise.IsClosed());
  noise.Close();
  EXPECT_TRUE(Until([&] { return echo.open == 0; }));
}

TEST(LiveSocket, OutlivesAClientThatDiesInTheMidstOfAFrame) {
  Echo echo;
  for (const std::size_t sent : {1u, 3u, 9u}) {
    WebClient client(echo.url());
    client.Upgrade();
    client.SendRaw(WebClient::FrameOf(WebClient::kText, std::string(1000, 'x')).substr(0, sent));
    EXPECT_TRUE(Until([&] { return echo.open == 1; }));
    client.Close();
    EXPECT_TRUE(Until([&] { return echo.open == 0; }));
  }
  WebClient client(echo.url());
  client.Upgrade();
  client.Send(WebClient::kText, "still here");
  EXPECT_TRUE(client.NextWith("still here"));
}

TEST(LiveSocket, AClientThatDoesNotReadIsDroppedAndHoldsUpNobody) {
  SocketOptions options;
  options.limits.waiting_bytes = 4 << 20;
  Echo echo(options, /*told_bytes=*/100'000);
  WebClient slow(echo.url()), quick(echo.url());
  slow.Upgrade();
  quick.Upgrade();
  EXPECT_TRUE(Until([&] { return echo.open == 2; }));
  while (echo.open == 2) ASSERT_TRUE(quick.Next());
  EXPECT_THAT(echo.log(), HasSubstr("dropped: does not read what it asks for\n"));
  const std::int64_t before = echo.periods;
  EXPECT_TRUE(Until([&] { return echo.periods > before + 10; }));
  EXPECT_TRUE(quick.Next());
}

TEST(LiveSocket, ClientsThatDoNotReadAreDroppedBeforeTheyTakeMuchMemoryTogether) {
  SocketOptions options;
  options.limits.all_waiting_bytes = 20 << 20;
  Echo echo(options);
  WebClient quick(echo.url());
  quick.Upgrade();
  std::vector<std::unique_ptr<WebClient>> slow;
  const std::string dropped = "dropped: the viewers do not read what they ask for, and this one leaves most of it\n";
  for (int client = 0; client < 50 && echo.log().find(dropped) == std::string::npos; ++client) {
    slow.push_back(std::make_unique<WebClient>(echo.url()));
    slow.back()->Upgrade();
    for (int k = 0; k < 20; ++k) slow.back()->Send(WebClient::kText, std::string(500'000, 'x'));
    quick.Send(WebClient::kText, "ping " + std::to_string(client));
    ASSERT_TRUE(quick.NextWith("ping " + std::to_string(client)));
  }
  EXPECT_TRUE(Until([&] { return echo.log().find(dropped) != std::string::npos; }));
  EXPECT_THAT(slow.size(), AllOf(::testing::Ge(2), ::testing::Le(20)));
  EXPECT_GE(echo.open, 2);  // the others stay
}

TEST(OutgoingMemory, CountsABodyOnceHoweverManyClientsWaitForIt) {
  const auto body = std::make_shared<const std::string>(1000, 'x');
  const Frame first{.head = "ab", .body = body}, second{.head = "abc", .body = body}, alone{.head = "abcd"};
  OutgoingMemory memory;
  for (const Frame* frame : {&first, &second, &alone}) memory.Add(*frame);
  EXPECT_EQ(memory.bytes(), 3 * sizeof(Frame) + 9 + 1000);
  memory.Remove(first);
  EXPECT_EQ(memory.bytes(), 2 * sizeof(Frame) + 7 + 1000);
  memory.Remove(second);
  EXPECT_EQ(memory.bytes(), sizeof(Frame) + 4);
  memory.Remove(alone);
  EXPECT_EQ(memory.bytes(), 0);
}

TEST(LiveSocket, ClosesRequestsThatDoNotCome) {
  SocketOptions options;
  options.limits.handshake = std::chrono::seconds(1);
  Echo echo(options);
  WebClient idle(echo.url()), half(echo.url());
  half.SendRaw("GET / HTTP/1.1\r\nHost:");
  EXPECT_TRUE(idle.IsClosed());
  EXPECT_TRUE(half.IsClosed());
}

TEST(LiveSocket, TakesTheNextFreePort) {
  Echo echo;
  const int taken = std::stoi(echo.url().substr(echo.url().rfind(':') + 1));
  SocketOptions options{.port = static_cast<std::uint16_t>(taken)};
  const SocketServer second(options, echo, [](const std::string&) {});
  EXPECT_GT(std::stoi(second.url().substr(second.url().rfind(':') + 1)), taken);
  options.address = "203.0.113.1";  // an address of no machine
  EXPECT_THAT([&] { SocketServer(options, echo, [](const std::string&) {}); },
              testing::ThrowsMessage<std::runtime_error>("cannot listen on 203.0.113.1:" + std::to_string(taken) +
                                                         ": Cannot assign requested address"));
}

TEST(LiveSocket, LetsAClientInOnceThereIsADescriptorAgain) {
  Echo echo;
  WebClient first(echo.url());  // lets all code run once: sanitizers look at objects of new types through pipes
  ASSERT_THAT(first.Upgrade("foxglove.sdk.v1"), StartsWith("HTTP/1.1 101"));
  ASSERT_TRUE(Until([&] { return echo.open == 1 && echo.periods > 0; }));
  rlimit usual{};
  getrlimit(RLIMIT_NOFILE, &usual);
  const rlimit small{.rlim_cur = 256, .rlim_max = usual.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &small), 0);
  std::vector<Descriptor> all;
  for (int fd = 0; fd >= 0;)
    if (fd = open("/dev/null", O_RDONLY | O_CLOEXEC); fd >= 0) all.emplace_back(fd);
  ASSERT_EQ(errno, EMFILE);
  all.pop_back();
  WebClient client(echo.url());  // takes the last one
  const std::int64_t seen = echo.periods;
  ASSERT_TRUE(Until([&] { return echo.periods > seen + 50; })) << "the server's thread goes on";
  EXPECT_EQ(echo.open, 1);
  all.clear();
  EXPECT_THAT(client.Upgrade("foxglove.sdk.v1"), StartsWith("HTTP/1.1 101"));
  setrlimit(RLIMIT_NOFILE, &usual);
}

TEST(LiveSocket, NoChildInheritsASocket) {
  Echo echo;
  WebClient client(echo.url());
  client.Upgrade();
  EXPECT_TRUE(Until([&] { return echo.open == 1; }));
  int sockets = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code gone;
    if (!std::filesystem::read_symlink(entry.path(), gone).string().starts_with("socket:")) continue;
    ++sockets;
    const int flags = fcntl(std::stoi(entry.path().filename()), F_GETFD);
    EXPECT_EQ(flags & FD_CLOEXEC, FD_CLOEXEC);
  }
  EXPECT_GE(sockets, 3);  // listening, both ends of the connection
}

TEST(LiveSocket, SaysGoodbyeAtTheEnd) {
  Echo echo;
  WebClient idle(echo.url()), client(echo.url());
  client.Upgrade();
  EXPECT_TRUE(client.NextWith("hello"));
  std::thread end([&] { echo.End(); });
  const auto goodbye = client.Next();
  client.Send(WebClient::kClose, goodbye ? goodbye->payload : "");
  EXPECT_TRUE(client.IsClosed());
  client.Close();
  const Deadline deadline("the end of the server");
  end.join();
  ASSERT_TRUE(goodbye);
  EXPECT_EQ(goodbye->opcode, WebClient::kClose);
  EXPECT_EQ(goodbye->payload, std::string("\x03\xe9", 2));  // 1001, going away
  EXPECT_TRUE(idle.IsClosed());
}

}  // namespace
}  // namespace mascot::test
