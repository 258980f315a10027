#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "orchestrator/control/run_control.h"
#include "orchestrator/live/server/foxglove_bytes.h"
#include "orchestrator/live/server/socket.h"

namespace mascot {

/// The server's side of the Foxglove WebSocket protocol (subprotocols foxglove.sdk.v1 and foxglove.websocket.v1), for
/// any number of clients: no socket, no thread, no clock. Whatever clients send, nothing is thrown.
class Foxglove {
 public:
  using Json = nlohmann::ordered_json;
  using Payload = std::shared_ptr<const std::string>;
  using Reply = std::function<void(const Answer&)>;
  /// Index in About::channels.
  using ChannelId = std::uint32_t;

  struct Schema {
    std::string name, encoding, text;
  };
  struct Channel {
    std::string topic, encoding;
    Schema schema;
  };
  /// A parameter of the run, such as a gain.
  struct Parameter {
    std::string name;
    Json value;
  };
  /// Values of playback's status, as the protocol has them.
  enum class Playing : std::uint8_t { kPlaying, kPaused, kBuffering, kEnded };
  struct Playback {
    Playing status = Playing::kPlaying;
    std::uint64_t time_ns = 0;
    float speed = 1;
  };
  /// The graph of connections: which nodes write and read each topic, and which offer each service.
  struct Connections {
    using Nodes = std::map<std::string, std::vector<std::string>>;
    Nodes writers, readers, providers;
  };
  /// What does not change.
  struct About {
    std::string name, session;  ///< a client that connects again to the same session knows the channels
    std::uint64_t end_ns = 0;   ///< end time of the run, which begins at 0
    std::vector<Channel> channels;
    std::function<Connections()> connections;
    std::string service;  ///< the service, which takes and gives JSON
    Schema request, response;
  };

  /// The server that this object works for.
  class Host {
   public:
    virtual ~Host() = default;
    virtual void Send(ClientId client, Frame frame) = 0;
    /// Whether to leave out messages for this client, because it has not read older ones.
    virtual bool IsSlow(ClientId client) const = 0;
    /// Called when a client has subscribed: messages that it has missed may be sent to it now.
    virtual void OnSubscribe(ClientId client, ChannelId channel) = 0;
    // Ask the run. `reply` is to be called later, not before the call returns.
    virtual void Ask(const Request& request, Reply reply) = 0;
    virtual void AskForGoal(const Goal& goal, Reply reply) = 0;
  };

  /// `host` must outlive this object.
  Foxglove(About about, Host& host) : about_(std::move(about)), host_(host) {}

  struct Permits {
    bool has_playback = false;  ///< the client speaks foxglove.sdk.v1, which has more kinds of messages
    bool may_steer = true;      ///< false: it may only watch, and all else that it asks for is refused
  };
  void OnOpen(ClientId client, const Permits& permits);
  /// Returns why to drop the client; empty: it stays.
  std::string OnMessage(ClientId client, bool is_text, std::span<const std::uint8_t> message);
  void OnClose(ClientId client) { clients_.erase(client); }

  std::vector<ClientId> clients() const;
  bool HasSubscriber(ChannelId channel) const;
  /// Sends a message to all clients that have subscribed to the channel and are not slow.
  void Publish(ChannelId channel, std::uint64_t time_ns, const Payload& payload);
  /// Sends a message to one client, slow or not, if it has subscribed to the channel.
  void PublishTo(ClientId client, ChannelId channel, std::uint64_t time_ns, const Payload& payload);
  /// Sends the simulated time to all clients that are not slow.
  void SendTime(std::uint64_t time_ns);
  /// Sets the parameters; clients that have subscribed to one that changed are told.
  void SetParameters(std::vector<Parameter> parameters);
  /// Sets how the run goes; all clients are told if more than the time has changed.
  void SetPlayback(const Playback& playback);

  // Limits of what one client may have at a time.
  static constexpr std::size_t kMaxClientChannels = 16;
  static constexpr std::size_t kMaxQuestions = 16;

 private:
  struct Client {
    std::map<ChannelId, std::uint32_t> subscriptions;  // the client's number of each
    std::map<std::uint32_t, Channel> channels;         // that it publishes, by its own number
    std::set<std::string> parameters;                  // whose changes it wants to know
    std::size_t questions = 0;                         // not answered yet
    Permits permits;
  };
  using Bytes = std::span<const std::uint8_t>;

  std::string OnText(ClientId id, Bytes text);
  void OnSubscribe(ClientId id, const Json& message);
  void OnUnsubscribe(ClientId id, const Json& message);
  void OnAdvertise(ClientId id, const Json& message);
  void OnUnadvertise(ClientId id, const Json& message);
  void OnGetParameters(ClientId id, const Json& message);
  void OnSetParameters(ClientId id, const Json& message);
  void OnSubscribeParameters(ClientId id, const Json& message);
  void OnUnsubscribeParameters(ClientId id, const Json& message);
  void OnSubscribeConnections(ClientId id, const Json& message);
  void OnUnsubscribeConnections(ClientId id, const Json& message);
  std::string OnClientMessage(ClientId id, Bytes message);
  std::string OnServiceCall(ClientId id, Bytes message);
  std::string OnPlaybackControl(ClientId id, Bytes message);

  /// Makes the requests one after the other, as long as they are granted; `reply` gets the last answer.
  void AskAll(ClientId id, std::vector<Request> requests, Reply reply);
  /// Passes a request on with `ask`, which gets the reply to call. If the client has too many unanswered requests, this
  /// one is refused at once.
  void Question(ClientId id, Reply reply, const std::function<void(Reply)>& ask);

  void SendText(ClientId id, const Json& message);
  void SendBytes(ClientId id, std::string message);
  void SendStatus(ClientId id, int level, const std::string& words);
  void SendParameters(ClientId id, std::span<const Parameter> sent, const Json& request);
  void SendPlayback(ClientId id, const std::string& request);

  const About about_;
  Host& host_;
  std::map<ClientId, Client> clients_;
  std::vector<Parameter> parameters_;
  Playback playback_;
};

}  // namespace mascot
