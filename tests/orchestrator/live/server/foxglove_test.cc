// The Foxglove protocol without sockets: what clients ask, and what is said to them.

#include "orchestrator/live/server/foxglove.h"

#include <gmock/gmock.h>

#include <random>

#include "orchestrator/control/request.h"
#include "tests/support/repeated.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using Json = Foxglove::Json;

std::span<const std::uint8_t> AsBytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

template <class... Numbers>
std::string Bytes(Numbers... numbers) {
  std::string bytes;
  (PutBytes(bytes, numbers), ...);
  return bytes;
}

/// A server for clients 1 and 2, which writes down what is sent and asked. Questions are answered by Answer().
class Server final : public Foxglove::Host {
 public:
  Server() {
    Foxglove::About about{
        .name = "here",
        .session = "s1",
        .end_ns = 1'500'000'000,
        .channels = {{"/a", "json", {"A", "jsonschema", "{}"}}, {"/b", "cdr", {"B", "ros2msg", ""}}},
        .connections =
            [] {
              return Foxglove::Connections{{{"/a", {"/agent_1"}}}, {{"/a", {"/agent_2"}}}, {{"/ask", {"/here"}}}};
            },
        .service = "/ask",
        .request = {"Wish", "jsonschema", "{}"},
        .response = {"Answer", "jsonschema", "{}"}};
    foxglove.emplace(std::move(about), *this);
    foxglove->OnOpen(1, {.has_playback = true});
    foxglove->OnOpen(2, {});
  }

  void Send(ClientId client, Frame frame) override {
    std::string whole = frame.head + (frame.body ? *frame.body : "");
    (frame.is_text ? texts : binaries)[client].push_back(std::move(whole));
  }
  bool IsSlow(ClientId client) const override { return client == slow; }
  void OnSubscribe(ClientId client, Foxglove::ChannelId channel) override { subscribed.emplace_back(client, channel); }
  void Ask(const Request& request, Foxglove::Reply reply) override {
    requests.push_back(request);
    replies.push_back(std::move(reply));
  }
  void AskForGoal(const Goal& goal, Foxglove::Reply reply) override {
    goals.push_back(goal);
    replies.push_back(std::move(reply));
  }

  /// What client 1 sends. Returns why it is dropped.
  std::string Say(const std::string& text) { return foxglove->OnMessage(1, true, AsBytes(text)); }
  std::string SayBytes(const std::string& bytes) { return foxglove->OnMessage(1, false, AsBytes(bytes)); }
  /// Answers all questions, also those that the answers lead to.
  void Reply(const Answer& answer) {
    while (!replies.empty()) {
      const auto reply = std::move(replies.front());
      replies.erase(replies.begin());
      reply(answer);
    }
  }
  /// The texts with this "op" to a client, so far.
  std::vector<Json> Texts(ClientId client, const std::string& op) {
    std::vector<Json> found;
    for (const std::string& text : texts[client])
      if (Json json = Json::parse(text); json["op"] == op) found.push_back(std::move(json));
    return found;
  }
  void Forget() {
    texts.clear();
    binaries.clear();
  }

  std::map<ClientId, std::vector<std::string>> texts, binaries;
  std::vector<std::pair<ClientId, Foxglove::ChannelId>> subscribed;
  std::vector<Request> requests;
  std::vector<Goal> goals;
  std::vector<Foxglove::Reply> replies;
  ClientId slow = 0;
  std::optional<Foxglove> foxglove;
};

TEST(Foxglove, IntroducesItselfFirst) {
  Server server;
  ASSERT_THAT(server.texts[1], SizeIs(3));
  const Json info = Json::parse(server.texts[1][0]);
  EXPECT_EQ(info["op"], "serverInfo");
  EXPECT_EQ(info["name"], "here");
  EXPECT_EQ(info["sessionId"], "s1");
  EXPECT_EQ(info["supportedEncodings"], Json::array({"cdr", "json"}));
  EXPECT_EQ(info["dataEndTime"], (Json{{"sec", 1}, {"nsec", 500'000'000}}));
  EXPECT_EQ(info["capabilities"].back(), "playbackControl");
  EXPECT_EQ(Json::parse(server.texts[1][1])["channels"][1], (Json{{"id", 1},
                                                                  {"topic", "/b"},
                                                                  {"encoding", "cdr"},
                                                                  {"schemaName", "B"},
                                                                  {"schemaEncoding", "ros2msg"},
                                                                  {"schema", ""}}));
  EXPECT_EQ(Json::parse(server.texts[1][2])["services"][0]["request"]["schemaName"], "Wish");
}

TEST(Foxglove, ToldOldClientsNothingOfPlayback) {
  Server server;
  EXPECT_THAT(Json::parse(server.texts[2][0])["capabilities"], testing::Not(testing::Contains("playbackControl")));
  EXPECT_THAT(server.binaries[1], SizeIs(1));
  EXPECT_THAT(server.binaries[2], IsEmpty());
}

TEST(Foxglove, SendsMessagesToThoseWhoSubscribed) {
  Server server;
  server.Forget();
  EXPECT_EQ(server.Say(R"({"op":"subscribe","subscriptions":[{"id":7,"channelId":1}]})"), "");
  EXPECT_THAT(server.subscribed, ElementsAre(std::pair<ClientId, Foxglove::ChannelId>(1, 1)));
  EXPECT_TRUE(server.foxglove->HasSubscriber(1));
  EXPECT_FALSE(server.foxglove->HasSubscriber(0));
  const auto payload = std::make_shared<const std::string>("payload");
  server.foxglove->Publish(1, 123, payload);
  server.foxglove->Publish(0, 123, payload);
  EXPECT_THAT(server.binaries[1], ElementsAre(Bytes('\1', 7u, std::uint64_t{123}) + "payload"));
  EXPECT_THAT(server.binaries[2], IsEmpty());
  EXPECT_EQ(server.Say(R"({"op":"unsubscribe","subscriptionIds":[7]})"), "");
  server.foxglove->Publish(1, 124, payload);
  EXPECT_THAT(server.binaries[1], SizeIs(1));
  EXPECT_THAT(server.texts[1], IsEmpty());
}

TEST(Foxglove, LeavesOutWhoIsSlow) {
  Server server;
  server.Say(R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":0}]})");
  server.Forget();
  server.slow = 1;
  const auto payload = std::make_shared<const std::string>("x");
  server.foxglove->Publish(0, 1, payload);
  server.foxglove->SendTime(1);
  EXPECT_THAT(server.binaries[1], IsEmpty());
  EXPECT_THAT(server.binaries[2], ElementsAre(Bytes('\2', std::uint64_t{1})));
  server.foxglove->PublishTo(1, 0, 1, payload);
  EXPECT_THAT(server.binaries[1], SizeIs(1));
}

TEST(Foxglove, SaysWhatIsWrongWithARequest) {
  Server server;
  server.Say(R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":0}]})");
  const std::pair<const char*, const char*> kWrong[] = {
      {R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":2}]})", "subscribe: there is no such channel"},
      {R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})", "subscribe: there is no such channel"},
      {R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":1}]})",
       "subscribe: this number, or this channel, has been subscribed already"},
      {R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":0}]})",
       "subscribe: this number, or this channel, has been subscribed already"},
      {R"({"op":"unsubscribe","subscriptionIds":[9]})", "unsubscribe: there is no such subscription"},
      {R"({"op":"advertise","channels":[{"id":1,"topic":"/x","encoding":"json","schemaName":"X"}]})",
       "advertise: expected /goal of geometry_msgs/msg/PoseStamped in cdr or json, got /x"},
      {R"({"op":"unadvertise","channelIds":[1]})", "unadvertise: there is no such channel"},
      {R"({"op":"fetchAsset","uri":"file:///etc/passwd"})", "there is no operation \"fetchAsset\""},
  };
  for (const auto& [request, words] : kWrong) {
    server.Forget();
    EXPECT_EQ(server.Say(request), "") << request;
    const auto status = server.Texts(1, "status");
    ASSERT_THAT(status, SizeIs(1)) << request;
    EXPECT_EQ(status[0]["message"], words);
    EXPECT_GE(status[0]["level"], 1);
  }
}

TEST(Foxglove, DropsWhoSendsNoMessageOfTheProtocol) {
  Server server;
  for (const char* text : {"", "hello", "[]", "{}", "{\"op\":1}", "{\"op\":", "\xff\xfe"})
    EXPECT_EQ(server.Say(text), "expected a JSON object with \"op\"") << text;
  for (const std::size_t levels : {65u, 100'000u, 300'000u}) {  // each a message of less than a megabyte
    const std::string deep = Repeated(levels, "[") + Repeated(levels, "]");
    for (const std::string& text :
         {deep, R"({"op":"subscribe","subscriptions":)" + deep + "}",
          R"({"op":"setParameters","parameters":[{"name":"law.p_gain","value":)" + deep + "}]}"})
      EXPECT_EQ(server.Say(text), "expected a JSON object with \"op\"");
  }
  EXPECT_EQ(server.SayBytes(""), "expected a binary message of kind 1, 2 or 3, got nothing");
  EXPECT_EQ(server.SayBytes("\x09zzz"), "expected a binary message of kind 1, 2 or 3, got another");
  EXPECT_EQ(server.SayBytes("\1\1"), "expected a message with a channel, got a shorter one");
  EXPECT_EQ(server.SayBytes(Bytes('\2', 0u, 1u, 0xffffffffu)), "expected a service call, got a shorter message");
  EXPECT_EQ(server.SayBytes(Bytes('\3', '\0', 1.0f)), "expected a request to control playback, got something else");
}

TEST(Foxglove, AsksTheRunForWhatAServiceCallWants) {
  Server server;
  const auto call = [&](const std::string& request, const std::string& encoding = "json", std::uint32_t service = 0) {
    return server.SayBytes(Bytes('\2', service, 5u, static_cast<std::uint32_t>(encoding.size())) + encoding + request);
  };
  server.Forget();
  EXPECT_EQ(call(R"({"ask":"event","toml":"goto = {}"})"), "");
  ASSERT_THAT(server.requests, SizeIs(1));
  EXPECT_EQ(server.requests[0].kind, Request::Kind::kEvent);
  EXPECT_EQ(server.requests[0].toml, "goto = {}");
  EXPECT_THAT(server.binaries[1], IsEmpty());
  server.Reply({true, "at tick 7"});
  EXPECT_THAT(server.binaries[1], ElementsAre(Bytes('\3', 0u, 5u, 4u) + R"(json{"granted":true,"words":"at tick 7"})"));
  const std::tuple<std::string, const char*, std::uint32_t, const char*> kWrong[] = {
      {"{}", "json", 0, "expected {\"ask\": pause | resume | stop | step | pace | seek | event | start | land | kill}"},
      {R"({"ask":"fly"})", "json", 0,
       "expected {\"ask\": pause | resume | stop | step | pace | seek | event | start | land | kill}"},
      {R"({"ask":"pace"})", "json", 0, "pace: expected a number as \"value\""},
      {R"({"ask":"event","toml":1})", "json", 0, "event: expected a text as \"toml\""},
      {"not json", "json", 0,
       "expected {\"ask\": pause | resume | stop | step | pace | seek | event | start | land | kill}"},
      {R"({"ask":"event","toml":"x","more":)" + Repeated(300'000, "[") + Repeated(300'000, "]") + "}", "json", 0,
       "expected {\"ask\": pause | resume | stop | step | pace | seek | event | start | land | kill}"},
      {"{}", "cdr", 0, "expected the encoding json, got cdr"},
      {"{}", "json", 3, "there is no such service"}};
  for (const auto& [request, encoding, service, words] : kWrong) {
    server.Forget();
    EXPECT_EQ(call(request, encoding, service), "");
    const auto failure = server.Texts(1, "serviceCallFailure");
    ASSERT_THAT(failure, SizeIs(1)) << request;
    EXPECT_EQ(failure[0]["message"], words);
    EXPECT_EQ(failure[0]["callId"], 5);
  }
  EXPECT_THAT(server.requests, SizeIs(1));
}

TEST(Foxglove, ReadsEveryRequest) {
  EXPECT_EQ(ReadRequest({{"ask", "pause"}}).kind, Request::Kind::kPause);
  EXPECT_EQ(ReadRequest({{"ask", "resume"}}).kind, Request::Kind::kResume);
  EXPECT_EQ(ReadRequest({{"ask", "stop"}}).kind, Request::Kind::kStop);
  EXPECT_EQ(ReadRequest({{"ask", "step"}, {"count", 3}}).number, 3);
  EXPECT_EQ(ReadRequest({{"ask", "pace"}, {"value", 2.5}}).number, 2.5);
  EXPECT_EQ(ReadRequest({{"ask", "seek"}, {"t_s", 12}}).number, 12);
}

TEST(Foxglove, SetsParametersByEventsAndTellsWhoWantsToKnow) {
  Server server;
  server.foxglove->SetParameters({{"law.p_gain", 1.0}, {"physics.wind.mean_m_per_s", {0, 0, 0}}});
  server.foxglove->OnMessage(2, true, AsBytes(R"({"op":"subscribeParameterUpdates","parameterNames":["law.p_gain"]})"));
  server.Forget();
  server.Say(R"({"op":"getParameters","parameterNames":[],"id":"all"})");
  EXPECT_EQ(server.Texts(1, "parameterValues"),
            std::vector<Json>{Json::parse(
                R"({"op":"parameterValues","parameters":[{"name":"law.p_gain","value":1.0,"type":"float64"},)"
                R"({"name":"physics.wind.mean_m_per_s","value":[0,0,0],"type":"float64_array"}],"id":"all"})")});
  server.Say(R"({"op":"setParameters","parameters":[{"name":"law.p_gain","value":0.5}],"id":"set"})");
  EXPECT_EQ(server.requests.at(0).toml, R"(set = { "law.p_gain" = 0.5 })");
  server.Reply({true, ""});
  EXPECT_EQ(server.Texts(1, "parameterValues")[1]["parameters"][0]["value"], 0.5) << "though it is so at the next tick";
  server.foxglove->SetParameters({{"law.p_gain", 0.5}, {"physics.wind.mean_m_per_s", {0, 0, 0}}});
  EXPECT_EQ(server.Texts(1, "parameterValues")[1]["id"], "set");
  ASSERT_THAT(server.Texts(2, "parameterValues"), SizeIs(1));
  EXPECT_THAT(server.Texts(2, "parameterValues")[0]["parameters"], SizeIs(1));
  server.Say(R"({"op":"setParameters","parameters":[{"name":"law.p_gain","value":-1}],"id":"bad"})");
  server.Reply({false, "law.p_gain: expected more"});
  EXPECT_EQ(server.Texts(1, "parameterValues").back()["parameters"][0]["value"], 0.5) << "what it is";
  server.Forget();
  server.Say(R"({"op":"setParameters","parameters":[{"name":"law.q","value":1}]})");
  server.Reply({false, "law.q: unknown key"});
  EXPECT_EQ(server.Texts(1, "status").at(0)["message"], "setParameters: law.q: unknown key");
}

TEST(Foxglove, RefusesWhoMayOnlyWatchAndOffersThemNothingElse) {
  Server server;
  server.foxglove->OnOpen(3, {.has_playback = true, .may_steer = false});
  EXPECT_EQ(server.Texts(3, "serverInfo").at(0)["capabilities"],
            Json::parse(R"(["time","parameters","parametersSubscribe","connectionGraph"])"));
  EXPECT_THAT(server.Texts(3, "advertiseServices"), IsEmpty());
  EXPECT_THAT(server.Texts(1, "advertiseServices"), SizeIs(1));
  server.foxglove->SetParameters({{"law.p_gain", 1.0}});
  const auto say = [&](const std::string& text) { return server.foxglove->OnMessage(3, true, AsBytes(text)); };
  const auto say_bytes = [&](const std::string& text) { return server.foxglove->OnMessage(3, false, AsBytes(text)); };
  say(R"({"op":"setParameters","parameters":[{"name":"law.p_gain","value":0.5}],"id":"set"})");
  EXPECT_EQ(server.Texts(3, "parameterValues").at(0)["parameters"][0]["value"], 1.0) << "they may read it";
  EXPECT_EQ(server.Texts(3, "status").at(0)["message"], "setParameters: this view only watches");
  EXPECT_EQ(say_bytes(Bytes('\2', 0u, 5u, 4u) + R"(json{"ask":"pause"})"), "");
  EXPECT_THAT(server.binaries[3].back(), testing::EndsWith(R"({"granted":false,"words":"this view only watches"})"));
  say_bytes(Bytes('\3', '\1', 2.0f, '\0', std::uint64_t{0}, 0u));
  EXPECT_EQ(server.Texts(3, "status").at(1)["message"], "this view only watches");
  say(R"({"op":"advertise","channels":[{"id":1,"topic":"/goal","encoding":"json",)"
      R"("schemaName":"geometry_msgs/msg/PoseStamped"}]})");
  say_bytes(Bytes('\1', 1u) + R"({"header":{"frame_id":"agent_2"},"pose":{"position":{"x":1,"y":2,"z":3}}})");
  EXPECT_THAT(server.requests, IsEmpty());
  EXPECT_THAT(server.goals, IsEmpty());
}

TEST(Foxglove, WritesNothingButTheValueIntoAnEvent) {
  EXPECT_EQ(SetKey("a", "x\" }\n[run]\nseed = 1 # ").toml, R"(set = { "a" = "x\" }\n[run]\nseed = 1 # " })");
  EXPECT_EQ(SetKey("a\" = 1, \"b", true).toml, R"(set = { "a\" = 1, \"b" = true })");
}

TEST(Foxglove, TakesGoalsInBothEncodings) {
  Server server;
  server.Say(R"({"op":"advertise","channels":[{"id":1,"topic":"/goal","encoding":"json",)"
             R"("schemaName":"geometry_msgs/msg/PoseStamped"},)"
             R"({"id":2,"topic":"/goal","encoding":"cdr","schemaName":"geometry_msgs/PoseStamped"}]})");
  server.Forget();
  EXPECT_EQ(server.SayBytes(Bytes('\1', 1u) +
                            R"({"header":{"frame_id":"agent_2"},"pose":{"position":{"x":1,"y":2.5,"z":-3}}})"),
            "");
  const std::string cdr = Bytes('\0', '\1', '\0', '\0', 0, 0u, 8u) + std::string("agent_3\0", 8) +
                          Bytes(0, 4.0, 5.0, 6.0, 0.0, 0.0, 0.0, 1.0);
  EXPECT_EQ(server.SayBytes(Bytes('\1', 2u) + cdr), "");
  ASSERT_THAT(server.goals, SizeIs(2));
  EXPECT_EQ(server.goals[0].frame_id, "agent_2");
  EXPECT_EQ(server.goals[0].z, -3);
  EXPECT_EQ(server.goals[1].frame_id, "agent_3");
  EXPECT_EQ(server.goals[1].y, 5);
  server.Reply({false, "nobody listens"});
  EXPECT_EQ(server.Texts(1, "status").at(0)["message"], "/goal: nobody listens");
  for (std::size_t cut = 0; cut < cdr.size(); ++cut)
    EXPECT_EQ(server.SayBytes(Bytes('\1', 2u) + cdr.substr(0, cut)),
              "expected a geometry_msgs/msg/PoseStamped in cdr, got something else");
  EXPECT_EQ(server.SayBytes(Bytes('\1', 1u) + R"({"pose":{"position":{"x":1}}})"),
            "expected a geometry_msgs/msg/PoseStamped in json, got something else");
  EXPECT_THAT(server.goals, SizeIs(2));
}

TEST(Foxglove, ControlsPlayback) {
  Server server;
  server.foxglove->SetPlayback({Foxglove::Playing::kPlaying, 5, 1});
  server.Forget();
  EXPECT_EQ(server.SayBytes(Bytes('\3', '\1', 2.0f, '\1', std::uint64_t{1'500'000'000}, 2u) + "r1"), "");
  server.Reply({true, ""});
  ASSERT_THAT(server.requests, SizeIs(3));
  EXPECT_EQ(server.requests[0].kind, Request::Kind::kSeek);
  EXPECT_EQ(server.requests[0].number, 1.5);
  EXPECT_EQ(server.requests[1].kind, Request::Kind::kPace);
  EXPECT_EQ(server.requests[1].number, 2);
  EXPECT_EQ(server.requests[2].kind, Request::Kind::kPause);
  EXPECT_THAT(server.binaries[1], ElementsAre(Bytes('\5', '\0', std::uint64_t{5}, 1.0f, 2u) + "r1"));
  server.Forget();
  server.foxglove->SetPlayback({Foxglove::Playing::kPlaying, 6, 1});
  EXPECT_THAT(server.binaries[1], IsEmpty());
  server.foxglove->SetPlayback({Foxglove::Playing::kEnded, 7, 1});
  EXPECT_THAT(server.binaries[1], ElementsAre(Bytes('\5', '\3', std::uint64_t{7}, 1.0f, 0u)));
}

TEST(Foxglove, AsksNoFurtherOnceAWishIsRefused) {
  Server server;
  server.SayBytes(Bytes('\3', '\0', 3.0f, '\1', std::uint64_t{0}, 0u));
  server.Reply({false, "a run does not seek"});
  EXPECT_THAT(server.requests, SizeIs(1));
  EXPECT_EQ(server.Texts(1, "status").at(0)["message"], "a run does not seek");
}

TEST(Foxglove, KnowsWhoHearsWhom) {
  Server server;
  server.Say(R"({"op":"subscribeConnectionGraph"})");
  const auto graph = server.Texts(1, "connectionGraphUpdate");
  ASSERT_THAT(graph, SizeIs(1));
  EXPECT_EQ(graph[0]["publishedTopics"], Json::parse(R"([{"name":"/a","publisherIds":["/agent_1"]}])"));
  EXPECT_EQ(graph[0]["subscribedTopics"], Json::parse(R"([{"name":"/a","subscriberIds":["/agent_2"]}])"));
  EXPECT_EQ(graph[0]["advertisedServices"], Json::parse(R"([{"name":"/ask","providerIds":["/here"]}])"));
}

TEST(Foxglove, LimitsQuestionsAndForgetsThoseOfClientsThatLeft) {
  Server server;
  const std::string pause = Bytes('\2', 0u, 5u, 4u) + R"(json{"ask":"pause"})";
  for (std::size_t i = 0; i < Foxglove::kMaxQuestions + 1; ++i) server.SayBytes(pause);
  EXPECT_THAT(server.requests, SizeIs(Foxglove::kMaxQuestions));
  EXPECT_THAT(server.binaries[1].back(), HasSubstr("too many requests are not answered yet"));
  server.Forget();
  server.foxglove->OnClose(1);
  server.Reply({true, ""});
  EXPECT_THAT(server.texts, IsEmpty());
  EXPECT_THAT(server.binaries, IsEmpty());
  EXPECT_THAT(server.foxglove->clients(), ElementsAre(2));
}

TEST(Foxglove, SurvivesRandomChangesOfGoodMessages) {
  Server server;
  const std::vector<std::string> good = {
      R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":0}]})",
      R"({"op":"setParameters","parameters":[{"name":"law.p_gain","value":0.5}],"id":"set"})",
      R"({"op":"advertise","channels":[{"id":1,"topic":"/goal","encoding":"cdr","schemaName":"geometry_msgs/PoseStamped"}]})",
      Bytes('\1', 1u, '\0', '\1', '\0', '\0', 0, 0u, 8u) + std::string("agent_3\0", 8) + std::string(56, '\0'),
      Bytes('\2', 0u, 5u, 4u) + R"(json{"ask":"step","count":3})",
      Bytes('\3', '\1', 2.0f, '\1', std::uint64_t{1}, 2u) + "r1"};
  std::mt19937 random(1);
  for (int i = 0; i < 20'000; ++i) {
    std::string message = good[random() % good.size()];
    const bool is_text = message.front() == '{';
    for (int changes = 0; changes < 3; ++changes) {
      const std::size_t at = random() % message.size();
      switch (random() % 4) {
        case 0:
          message[at] = static_cast<char>(random());
          break;
        case 1:
          message.resize(at + 1);
          break;
        case 2:
          message.insert(at, 1, "{}[]\",:0"[random() % 8]);
          break;
        default:
          break;
      }
    }
    EXPECT_NO_THROW(server.foxglove->OnMessage(1, is_text, AsBytes(message)));
    server.Reply({i % 2 == 0, "words"});
    server.Forget();
  }
}

}  // namespace
}  // namespace mascot
