#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mascot {

/// One connection by WebSocket. Numbers are not used again.
using ClientId = std::uint64_t;

/// One message to a client, of two parts.
struct Frame {
  bool is_text = false;
  std::string head = {};                         ///< the part that differs from client to client
  std::shared_ptr<const std::string> body = {};  ///< the part that clients share, behind the head; null: nothing
};

/// The answer to a GET.
struct HttpAnswer {
  unsigned status = 200;
  std::vector<std::pair<std::string, std::string>> headers = {};
  std::string body = {};
};

/// Limits of a server.
struct SocketLimits {
  std::size_t clients = 64;                           ///< clients by WebSocket; a further one gets 503
  std::size_t connections = 256;                      ///< connections of both kinds; a further one is not answered
  std::size_t message_bytes = std::size_t{1} << 20;   ///< longest message of a client
  std::size_t waiting_bytes = std::size_t{64} << 20;  ///< a client that leaves more than this unread is dropped
  /// If all clients together leave more than this unread, as it lies in memory, the one that leaves most is dropped.
  std::size_t all_waiting_bytes = std::size_t{256} << 20;
  std::chrono::seconds handshake{5};        ///< time for a request to arrive
  std::chrono::milliseconds goodbye{1000};  ///< at the end, time for clients to take what waits for them
};

struct SocketOptions {
  std::string address = "127.0.0.1";           ///< an IP address or a name
  std::uint16_t port = 8765;                   ///< if it is taken, one of the next hundred; 0: any free one
  std::vector<std::string> subprotocols = {};  ///< the first one that a client offers is taken
  /// Origins of pages that may speak to the server, besides its own (origin.h).
  std::vector<std::string> allowed_origins = {};
  std::chrono::milliseconds period{33};  ///< of SocketUser::OnTimer()
  SocketLimits limits = {};
};

/// What a SocketServer serves. All functions are called in the server's thread. If a function for a client throws, the
/// error is logged, and the client is dropped; if OnTimer() throws, the server ends.
class SocketUser {
 public:
  virtual ~SocketUser() = default;
  /// The answer to GET `target`, a path and perhaps a query, as sent.
  virtual HttpAnswer Get(std::string_view target) = 0;
  /// `subprotocol`: that of SocketOptions::subprotocols on which both sides agreed. `target`: what the client asked
  /// for, a path and perhaps a query, as sent.
  virtual void OnOpen(ClientId client, const std::string& subprotocol, std::string_view target) = 0;
  /// Called for a message, text in UTF-8 or bytes. Returns why to drop the client; empty: it stays.
  virtual std::string OnMessage(ClientId client, bool is_text, std::span<const std::uint8_t> message) = 0;
  virtual void OnClose(ClientId client) = 0;
  virtual void OnTimer() = 0;
};

/// HTTP and WebSocket on one port, in a thread of its own. Refuses requests whose Host or Origin is foreign
/// (live/origin.h). Its sockets are not inherited by child processes. An exception that leaves the thread ends the
/// server and nothing else: it says so in the log, drops all clients, and closes the port.
class SocketServer {
 public:
  /// Listens from now on. `log` takes a line about a client that was dropped or refused, in the server's thread. Throws
  /// std::runtime_error if no port is free. `user` must outlive this object, and is called only after Start().
  SocketServer(SocketOptions options, SocketUser& user, std::function<void(const std::string&)> log);
  /// Closes the connections in order, sends waiting messages for at most SocketLimits::goodbye, and ends the thread.
  ~SocketServer();
  SocketServer(const SocketServer&) = delete;
  SocketServer& operator=(const SocketServer&) = delete;

  /// Starts the thread.
  void Start();
  /// "http://127.0.0.1:8765"
  std::string url() const;
  std::uint16_t port() const;
  /// Calls `function` in the server's thread, soon. From any thread.
  void Post(std::function<void()> function);
  /// Ends the server, because of an error in our own code. From any thread.
  void Fail(const std::string& why);
  /// Whether an error in our own code has ended the server. From any thread.
  bool has_failed() const;

  // In the server's thread only.
  /// Sends a message; nothing if the client is gone.
  void Send(ClientId client, Frame frame);
  /// Bytes that wait until the client reads; 0 if it is gone.
  std::size_t Waiting(ClientId client) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mascot
