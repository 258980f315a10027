#pragma once
// A client of HTTP and WebSocket by hand, for tests of orchestrator/live/: it can do what no library would.

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include "tests/support/waits.h"

namespace mascot::test {

/// A connection to 127.0.0.1. What is waited for comes within 20 s, or the test fails.
class WebClient {
 public:
  explicit WebClient(const std::string& url) : host_(url.substr(url.find("//") + 2)) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_port = htons(static_cast<std::uint16_t>(std::stoi(host_.substr(host_.find(':') + 1))));
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (connect(socket_, reinterpret_cast<sockaddr*>(&at), sizeof at) != 0) Close();
  }
  ~WebClient() { Close(); }
  WebClient(const WebClient&) = delete;
  WebClient& operator=(const WebClient&) = delete;

  const std::string& host() const { return host_; }
  void Close() {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
  }
  void SendRaw(std::string_view bytes) const { ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL); }

  /// Status line, headers and body of the answer to a request; empty: none came, the connection is closed.
  std::string Get(const std::string& path, const std::string& headers = "") {
    return Ask("GET " + path + " HTTP/1.1\r\nHost: " + host_ + "\r\n" + headers + "\r\n");
  }
  std::string Ask(const std::string& request) {
    SendRaw(request);
    std::size_t end = 0;
    while ((end = in_.find("\r\n\r\n")) == std::string::npos)
      if (!Receive()) return {};
    const std::string head = in_.substr(0, end + 4);
    const auto length = head.find("Content-Length: ");
    const std::size_t body = length == std::string::npos ? 0 : std::stoul(head.substr(length + 16));
    while (in_.size() < head.size() + body)
      if (!Receive()) return {};
    std::string answer = in_.substr(0, head.size() + body);
    in_.erase(0, answer.size());
    return answer;
  }
  /// Becomes a WebSocket. Returns the answer.
  std::string Upgrade(const std::string& subprotocol = "foxglove.sdk.v1", const std::string& headers = "",
                      const std::string& target = "/") {
    return Get(target,
               "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: "
               "dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: " +
                   subprotocol + "\r\n" + headers);
  }

  static constexpr int kText = 1, kBinary = 2, kClose = 8, kPing = 9;
  /// A frame as a client sends it, masked with zeros.
  static std::string FrameOf(int opcode, std::string_view payload) {
    std::string frame{static_cast<char>(0x80 | opcode)};
    if (payload.size() < 126) {
      frame += static_cast<char>(0x80 | payload.size());
    } else {
      frame += static_cast<char>(0x80 | 127);
      for (int shift = 56; shift >= 0; shift -= 8) frame += static_cast<char>(payload.size() >> shift);
    }
    return frame.append(4, '\0').append(payload);
  }
  void Send(int opcode, std::string_view payload) const { SendRaw(FrameOf(opcode, payload)); }

  struct Frame {
    int opcode = 0;
    std::string payload;
  };
  /// The next frame; nothing: the server has closed the connection.
  std::optional<Frame> Next() {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(in_[i]); };
    if (!Have(2)) return std::nullopt;
    std::size_t head = 2, length = byte(1) & 0x7fu;
    const std::size_t more = length == 126 ? 2 : length == 127 ? 8 : 0;
    if (!Have(head + more)) return std::nullopt;
    if (more > 0) length = 0;
    for (std::size_t i = 0; i < more; ++i) length = length << 8 | byte(head + i);
    head += more;
    if (!Have(head + length)) return std::nullopt;
    Frame frame{byte(0) & 0x0f, in_.substr(head, length)};
    in_.erase(0, head + length);
    return frame;
  }
  /// The next frame that holds `text`; nothing: the connection was closed before, or a minute has passed.
  std::optional<Frame> NextWith(std::string_view text) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    for (auto frame = Next(); frame && std::chrono::steady_clock::now() < deadline; frame = Next())
      if (frame->payload.find(text) != std::string::npos) return frame;
    return std::nullopt;
  }
  /// Whether the server closes the connection, after whatever it still sends for a while.
  bool IsClosed() {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (Receive()) {
      in_.clear();
      if (std::chrono::steady_clock::now() > deadline) return false;
    }
    return !timed_out_;
  }

 private:
  bool Have(std::size_t bytes) {
    while (in_.size() < bytes)
      if (!Receive()) return false;
    return true;
  }
  bool Receive() {
    if (socket_ < 0) return false;
    pollfd ready{socket_, POLLIN, 0};
    char bytes[65536];
    timed_out_ = poll(&ready, 1, 20'000) == 0;
    if (timed_out_) ADD_FAILURE() << "nothing came within 20 s";
    const ssize_t got = timed_out_ ? 0 : ::recv(socket_, bytes, sizeof bytes, 0);
    if (got > 0) in_.append(bytes, static_cast<std::size_t>(got));
    return got > 0;
  }

  std::string host_;
  int socket_ = -1;
  std::string in_;
  bool timed_out_ = false;
};

}  // namespace mascot::test
