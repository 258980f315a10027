#include "orchestrator/live/server/foxglove.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>

#include "orchestrator/control/request.h"
#include "orchestrator/formats/compact_json.h"
#include "orchestrator/formats/outside_json.h"

namespace mascot {
namespace {

using Json = Foxglove::Json;

constexpr int kWarning = 1, kError = 2;
constexpr std::string_view kGoalTopic = "/goal";
constexpr std::string_view kGoalType = "geometry_msgs/msg/PoseStamped", kOldGoalType = "geometry_msgs/PoseStamped";
constexpr std::string_view kEncodings[] = {"cdr", "json"};
constexpr std::string_view kWatching[] = {"time", "parameters", "parametersSubscribe", "connectionGraph"};
constexpr std::string_view kSteering[] = {"services", "clientPublish"};
constexpr const char* kOnlyWatches = "this view only watches";
constexpr std::uint32_t kServiceId = 0;
constexpr std::size_t kLongestEcho = 200;  // of what a client sent

enum class FromServer : char { kMessage = 1, kTime, kServiceResponse, kAsset, kPlayback };
enum class FromClient : std::uint8_t { kMessage = 1, kServiceRequest, kPlayback };

std::string Begin(FromServer kind) { return {static_cast<char>(kind)}; }

std::optional<std::uint32_t> U32(const Json& json) {
  if (!json.is_number_integer() || json < 0 || json > 0xffffffffU) return std::nullopt;
  return json.get<std::uint32_t>();
}
/// The list in this field; empty if there is none.
const Json& List(const Json& message, const char* field) {
  static const Json kNone = Json::array();
  const auto found = message.find(field);
  return found != message.end() && found->is_array() ? *found : kNone;
}
std::optional<std::uint32_t> U32(const Json& message, const char* field) {
  return message.is_object() && message.contains(field) ? U32(message[field]) : std::nullopt;
}
std::string Text(const Json& message, const char* field) {
  const bool has = message.is_object() && message.contains(field) && message[field].is_string();
  return has ? message[field].get<std::string>() : "";
}
/// An id that a client gives a request, to be repeated in the response: null if it gave none.
Json RequestOf(const Json& message) {
  const std::string id = Text(message, "id");
  return id.empty() ? Json(nullptr) : Json(id);
}

Json SchemaJson(const Foxglove::Schema& schema) {
  return {
      {"encoding", "json"}, {"schemaName", schema.name}, {"schemaEncoding", schema.encoding}, {"schema", schema.text}};
}

Json TimeJson(std::uint64_t time_ns) { return {{"sec", time_ns / 1'000'000'000}, {"nsec", time_ns % 1'000'000'000}}; }

Json NodesJson(const Foxglove::Connections::Nodes& nodes, const char* ids) {
  Json json = Json::array();
  for (const auto& [name, names] : nodes) json.push_back({{"name", name}, {ids, names}});
  return json;
}

}  // namespace

void Foxglove::OnOpen(ClientId id, const Permits& permits) {
  clients_[id].permits = permits;
  Json capabilities = kWatching;
  if (permits.may_steer) {
    for (const std::string_view capability : kSteering) capabilities.push_back(capability);
    if (permits.has_playback) capabilities.push_back("playbackControl");
  }
  SendText(id, {{"op", "serverInfo"},
                {"name", about_.name},
                {"capabilities", capabilities},
                {"supportedEncodings", kEncodings},
                {"metadata", Json::object()},
                {"sessionId", about_.session},
                {"dataStartTime", TimeJson(0)},
                {"dataEndTime", TimeJson(about_.end_ns)}});
  Json channels = Json::array();
  for (const Channel& channel : about_.channels)
    channels.push_back({{"id", channels.size()},
                        {"topic", channel.topic},
                        {"encoding", channel.encoding},
                        {"schemaName", channel.schema.name},
                        {"schemaEncoding", channel.schema.encoding},
                        {"schema", channel.schema.text}});
  SendText(id, {{"op", "advertise"}, {"channels", channels}});
  const Json service = {{"id", kServiceId},
                        {"name", about_.service},
                        {"type", about_.service},
                        {"request", SchemaJson(about_.request)},
                        {"response", SchemaJson(about_.response)}};
  if (permits.may_steer) SendText(id, {{"op", "advertiseServices"}, {"services", Json::array({service})}});
  SendPlayback(id, "");
}

std::string Foxglove::OnMessage(ClientId id, bool is_text, Bytes message) {
  if (!clients_.contains(id)) return {};
  if (is_text) return OnText(id, message);
  const auto kind = message.empty() ? 0 : message[0];
  const Bytes rest = message.empty() ? message : message.subspan(1);
  switch (static_cast<FromClient>(kind)) {
    case FromClient::kMessage:
      return OnClientMessage(id, rest);
    case FromClient::kServiceRequest:
      return OnServiceCall(id, rest);
    case FromClient::kPlayback:
      return OnPlaybackControl(id, rest);
  }
  return fmt::format("expected a binary message of kind 1, 2 or 3, got {}", message.empty() ? "nothing" : "another");
}

std::string Foxglove::OnText(ClientId id, Bytes text) {
  struct Operation {
    std::string_view name;
    void (Foxglove::*act)(ClientId, const Json&);
  };
  static constexpr Operation kOperations[] = {
      {"subscribe", &Foxglove::OnSubscribe},
      {"unsubscribe", &Foxglove::OnUnsubscribe},
      {"advertise", &Foxglove::OnAdvertise},
      {"unadvertise", &Foxglove::OnUnadvertise},
      {"getParameters", &Foxglove::OnGetParameters},
      {"setParameters", &Foxglove::OnSetParameters},
      {"subscribeParameterUpdates", &Foxglove::OnSubscribeParameters},
      {"unsubscribeParameterUpdates", &Foxglove::OnUnsubscribeParameters},
      {"subscribeConnectionGraph", &Foxglove::OnSubscribeConnections},
      {"unsubscribeConnectionGraph", &Foxglove::OnUnsubscribeConnections},
  };
  const auto message = JsonOrNull<Json>(TextOf(text));
  const std::string name = Text(message, "op");
  if (name.empty()) return "expected a JSON object with \"op\"";
  const auto* operation = std::ranges::find(kOperations, name, &Operation::name);
  if (operation == std::end(kOperations))
    SendStatus(id, kWarning, "there is no operation \"" + name.substr(0, kLongestEcho) + "\"");
  else
    (this->*operation->act)(id, message);
  return {};
}

void Foxglove::OnSubscribe(ClientId id, const Json& message) {
  auto& subscriptions = clients_[id].subscriptions;
  for (const Json& wanted : List(message, "subscriptions")) {
    const auto number = U32(wanted, "id"), channel = U32(wanted, "channelId");
    const auto is_taken = [&](const auto& subscription) { return subscription.second == number; };
    if (!number || !channel || *channel >= about_.channels.size()) {
      SendStatus(id, kError, "subscribe: there is no such channel");
    } else if (subscriptions.contains(*channel) || std::ranges::any_of(subscriptions, is_taken)) {
      SendStatus(id, kError, "subscribe: this number, or this channel, has been subscribed already");
    } else {
      subscriptions[*channel] = *number;
      host_.OnSubscribe(id, *channel);
    }
  }
}

void Foxglove::OnUnsubscribe(ClientId id, const Json& message) {
  for (const Json& number : List(message, "subscriptionIds")) {
    const auto is_it = [&](const auto& subscription) { return subscription.second == U32(number); };
    if (std::erase_if(clients_[id].subscriptions, is_it) == 0)
      SendStatus(id, kError, "unsubscribe: there is no such subscription");
  }
}

void Foxglove::OnAdvertise(ClientId id, const Json& message) {
  auto& channels = clients_[id].channels;
  for (const Json& offered : List(message, "channels")) {
    const auto number = U32(offered, "id");
    const Channel channel{Text(offered, "topic"), Text(offered, "encoding"), {Text(offered, "schemaName"), "", ""}};
    const bool is_goal = channel.schema.name == kGoalType || channel.schema.name == kOldGoalType;
    if (!number || channel.topic != kGoalTopic || std::ranges::count(kEncodings, channel.encoding) == 0 || !is_goal)
      SendStatus(id, kError,
                 fmt::format("advertise: expected {} of {} in cdr or json, got {}", kGoalTopic, kGoalType,
                             channel.topic.substr(0, kLongestEcho)));
    else if (channels.contains(*number) || channels.size() >= kMaxClientChannels)
      SendStatus(id, kError, "advertise: this number is taken, or there are too many channels");
    else
      channels[*number] = channel;
  }
}

void Foxglove::OnUnadvertise(ClientId id, const Json& message) {
  for (const Json& number : List(message, "channelIds"))
    if (!U32(number) || clients_[id].channels.erase(*U32(number)) == 0)
      SendStatus(id, kError, "unadvertise: there is no such channel");
}

void Foxglove::OnGetParameters(ClientId id, const Json& message) {
  const Json& names = List(message, "parameterNames");
  std::vector<Parameter> sent;
  std::ranges::copy_if(parameters_, std::back_inserter(sent), [&](const Parameter& parameter) {
    return names.empty() || std::ranges::find(names, Json(parameter.name)) != names.end();
  });
  SendParameters(id, sent, RequestOf(message));
}

void Foxglove::OnSetParameters(ClientId id, const Json& message) {
  std::vector<Request> requests;
  std::map<std::string, Json> asked;
  for (const Json& parameter : List(message, "parameters")) {
    Json& value = asked[Text(parameter, "name")] = parameter.is_object() ? parameter.value("value", Json()) : Json();
    requests.push_back(SetKey(Text(parameter, "name"), value));
  }
  if (requests.size() > kMaxQuestions) return SendStatus(id, kError, "setParameters: too many at once");
  AskAll(id, std::move(requests), [this, id, asked, request = RequestOf(message)](const Answer& answer) {
    if (!answer.granted) SendStatus(id, kError, "setParameters: " + answer.words);
    std::vector<Parameter> now;
    for (const Parameter& parameter : parameters_)
      if (const auto it = asked.find(parameter.name); it != asked.end())
        now.push_back({parameter.name, answer.granted ? it->second : parameter.value});  // granted for the next tick
    SendParameters(id, now, request);
  });
}

void Foxglove::OnSubscribeParameters(ClientId id, const Json& message) {
  const Json& names = List(message, "parameterNames");
  for (const Parameter& parameter : parameters_)
    if (names.empty() || std::ranges::find(names, Json(parameter.name)) != names.end())
      clients_[id].parameters.insert(parameter.name);
}

void Foxglove::OnUnsubscribeParameters(ClientId id, const Json& message) {
  const Json& names = List(message, "parameterNames");
  if (names.empty()) clients_[id].parameters.clear();
  for (const Json& name : names)
    if (name.is_string()) clients_[id].parameters.erase(name.get<std::string>());
}

void Foxglove::OnSubscribeConnections(ClientId id, const Json&) {
  const Connections connections = about_.connections();
  SendText(id, {{"op", "connectionGraphUpdate"},
                {"publishedTopics", NodesJson(connections.writers, "publisherIds")},
                {"subscribedTopics", NodesJson(connections.readers, "subscriberIds")},
                {"advertisedServices", NodesJson(connections.providers, "providerIds")},
                {"removedTopics", Json::array()},
                {"removedServices", Json::array()}});
}

void Foxglove::OnUnsubscribeConnections(ClientId, const Json&) {}  // they do not change: no update would come

std::string Foxglove::OnClientMessage(ClientId id, Bytes message) {
  ByteReader bytes(message);
  const auto number = bytes.Take<std::uint32_t>();
  if (!bytes.ok()) return "expected a message with a channel, got a shorter one";
  const auto channel = clients_[id].channels.find(number);
  if (channel == clients_[id].channels.end()) {
    SendStatus(id, kError, "a message on a channel that was not advertised");
    return {};
  }
  const auto goal = ReadGoal(channel->second.encoding, bytes.rest());
  if (!goal) return fmt::format("expected a {} in {}, got something else", kGoalType, channel->second.encoding);
  const Reply reply = [this, id](const Answer& answer) {
    SendStatus(id, answer.granted ? 0 : kError, std::string(kGoalTopic) + ": " + answer.words);
  };
  Question(id, reply, [&](Reply later) { host_.AskForGoal(*goal, std::move(later)); });
  return {};
}

std::string Foxglove::OnServiceCall(ClientId id, Bytes message) {
  ByteReader bytes(message);
  const auto service = bytes.Take<std::uint32_t>(), call = bytes.Take<std::uint32_t>();
  const std::string encoding(bytes.TakeText());
  if (!bytes.ok()) return "expected a service call, got a shorter message";
  const auto fail = [&](const std::string& why) {
    SendText(id, {{"op", "serviceCallFailure"}, {"serviceId", service}, {"callId", call}, {"message", why}});
    return std::string();
  };
  if (service != kServiceId) return fail("there is no such service");
  if (encoding != "json") return fail("expected the encoding json, got " + encoding.substr(0, kLongestEcho));
  Request request;
  try {
    request = ReadRequest(JsonOrNull<Json>(TextOf(bytes.rest())));
  } catch (const std::invalid_argument& error) {
    return fail(error.what());
  }
  AskAll(id, {request}, [this, id, service, call](const Answer& answer) {
    std::string response = Begin(FromServer::kServiceResponse);
    for (const std::uint32_t number : {service, call, std::uint32_t{4}}) PutBytes(response, number);
    SendBytes(id, response + "json" + CompactJson({{"granted", answer.granted}, {"words", answer.words}}));
  });
  return {};
}

std::string Foxglove::OnPlaybackControl(ClientId id, Bytes message) {
  ByteReader bytes(message);
  const auto command = bytes.Take<std::uint8_t>();
  const auto speed = bytes.Take<float>();
  const bool seeks = bytes.Take<std::uint8_t>() != 0;
  const auto time_ns = bytes.Take<std::uint64_t>();
  const std::string request(bytes.TakeText().substr(0, kLongestEcho));
  if (!bytes.ok() || command > 1) return "expected a request to control playback, got something else";
  std::vector<Request> requests;
  if (seeks) requests.push_back({.kind = Request::Kind::kSeek, .number = static_cast<double>(time_ns) * 1e-9});
  if (speed != playback_.speed) requests.push_back({.kind = Request::Kind::kPace, .number = speed});
  requests.push_back({.kind = command == 0 ? Request::Kind::kResume : Request::Kind::kPause});
  AskAll(id, std::move(requests), [this, id, request](const Answer& answer) {
    if (!answer.granted) SendStatus(id, kError, answer.words);
    SendPlayback(id, request);
  });
  return {};
}

void Foxglove::AskAll(ClientId id, std::vector<Request> requests, Reply reply) {
  if (requests.empty()) return reply({.granted = true});
  const Request first = requests.front();
  requests.erase(requests.begin());
  const Reply next = [this, id, requests = std::move(requests), reply](const Answer& answer) {
    if (answer.granted && !requests.empty()) return AskAll(id, requests, reply);
    reply(answer);
  };
  Question(id, next, [&](Reply later) { host_.Ask(first, std::move(later)); });
}

void Foxglove::Question(ClientId id, Reply reply, const std::function<void(Reply)>& ask) {
  if (!clients_[id].permits.may_steer) return reply({false, kOnlyWatches});
  if (clients_[id].questions >= kMaxQuestions) return reply({false, "too many requests are not answered yet"});
  ++clients_[id].questions;
  ask([this, id, reply = std::move(reply)](const Answer& answer) {
    const auto client = clients_.find(id);
    if (client == clients_.end()) return;  // it left
    --client->second.questions;
    reply(answer);
  });
}

std::vector<ClientId> Foxglove::clients() const {
  std::vector<ClientId> ids;
  for (const auto& [id, client] : clients_) ids.push_back(id);
  return ids;
}

bool Foxglove::HasSubscriber(ChannelId channel) const {
  return std::ranges::any_of(clients_, [&](const auto& row) { return row.second.subscriptions.contains(channel); });
}

void Foxglove::PublishTo(ClientId id, ChannelId channel, std::uint64_t time_ns, const Payload& payload) {
  const auto client = clients_.find(id);
  if (client == clients_.end()) return;
  const auto subscription = client->second.subscriptions.find(channel);
  if (subscription == client->second.subscriptions.end()) return;
  std::string head = Begin(FromServer::kMessage);
  PutBytes(head, subscription->second);
  PutBytes(head, time_ns);
  host_.Send(id, {.head = std::move(head), .body = payload});
}

void Foxglove::Publish(ChannelId channel, std::uint64_t time_ns, const Payload& payload) {
  for (const auto& [id, client] : clients_)
    if (!host_.IsSlow(id)) PublishTo(id, channel, time_ns, payload);
}

void Foxglove::SendTime(std::uint64_t time_ns) {
  std::string message = Begin(FromServer::kTime);
  PutBytes(message, time_ns);
  for (const auto& [id, client] : clients_)
    if (!host_.IsSlow(id)) SendBytes(id, message);
  playback_.time_ns = time_ns;
}

void Foxglove::SetParameters(std::vector<Parameter> parameters) {
  const auto has_changed = [&, before = std::exchange(parameters_, std::move(parameters))](const Parameter& now) {
    const auto old = std::ranges::find(before, now.name, &Parameter::name);
    return old == before.end() || old->value != now.value;
  };
  if (std::ranges::none_of(parameters_, has_changed)) return;
  for (const auto& [id, client] : clients_) {
    std::vector<Parameter> changed;
    std::ranges::copy_if(parameters_, std::back_inserter(changed),
                         [&has_changed, &names = client.parameters](const Parameter& parameter) {
                           return names.contains(parameter.name) && has_changed(parameter);
                         });
    if (!changed.empty()) SendParameters(id, changed, nullptr);
  }
}

void Foxglove::SetPlayback(const Playback& playback) {
  const Playback before = std::exchange(playback_, playback);
  if (before.status == playback.status && before.speed == playback.speed) return;
  for (const auto& [id, client] : clients_) SendPlayback(id, "");
}

void Foxglove::SendText(ClientId id, const Json& message) {
  host_.Send(id, {.is_text = true, .head = CompactJson(message)});
}

void Foxglove::SendBytes(ClientId id, std::string message) { host_.Send(id, {.head = std::move(message)}); }

void Foxglove::SendStatus(ClientId id, int level, const std::string& words) {
  SendText(id, {{"op", "status"}, {"level", level}, {"message", words}});
}

void Foxglove::SendParameters(ClientId id, std::span<const Parameter> sent, const Json& request) {
  Json parameters = Json::array();
  for (const Parameter& parameter : sent) {
    parameters.push_back({{"name", parameter.name}, {"value", parameter.value}});
    if (parameter.value.is_number()) parameters.back()["type"] = "float64";
    if (parameter.value.is_array()) parameters.back()["type"] = "float64_array";
  }
  Json message = {{"op", "parameterValues"}, {"parameters", parameters}};
  if (!request.is_null()) message["id"] = request;
  SendText(id, message);
}

void Foxglove::SendPlayback(ClientId id, const std::string& request) {
  if (!clients_[id].permits.has_playback) return;
  std::string message = Begin(FromServer::kPlayback);
  message += static_cast<char>(playback_.status);
  PutBytes(message, playback_.time_ns);
  PutBytes(message, playback_.speed);
  PutBytes(message, static_cast<std::uint32_t>(request.size()));
  SendBytes(id, message + request);
}

}  // namespace mascot
