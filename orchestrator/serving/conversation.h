#pragma once

#include <cstddef>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "orchestrator/serving/team_service.h"

namespace mascot {

/// What one client of `orchestrator serve` says and is answered (docs/serve.md), without its socket: a message in, its
/// answer out. The first message must be hello: anything else ends the conversation.
class Conversation {
 public:
  /// Longest messages, in bytes: before hello, and after it.
  struct Limits {
    std::size_t first = std::size_t{4} << 10, message = std::size_t{16} << 20;
  };
  /// `drive` gets the name of each request that changes the team, before it is carried out; it throws
  /// std::runtime_error if another client steps the team.
  Conversation(TeamService& team, std::function<void(const std::string& request)> drive, Limits limits);

  /// Whether the client has said hello.
  bool is_known() const { return is_known_; }
  /// Whether the next message is a frame of the binary form; else it is a line.
  bool is_binary() const { return is_binary_; }
  /// Whether nothing more is said after the newest answer.
  bool is_over() const { return is_over_; }
  /// How long the next message may be (bytes).
  std::size_t most() const { return is_known_ ? limits_.message : limits_.first; }

  /// A line, without its end. Returns the bytes of the answer.
  std::string OnLine(std::string_view line) { return OnJson(line); }
  /// A frame: its kind, and its content.
  std::string OnFrame(std::uint8_t kind, std::string_view content);
  /// Ends the conversation. Returns the bytes of the answer that says why.
  std::string Refuse(const std::string& words);

 private:
  using Json = TeamService::Json;

  std::string OnJson(std::string_view text);
  std::string Framed(std::string json) const;

  TeamService& team_;
  const std::function<void(const std::string& request)> drive_;
  const Limits limits_;
  bool is_known_ = false, is_binary_ = false, is_over_ = false;
};

}  // namespace mascot
