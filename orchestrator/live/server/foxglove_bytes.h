#pragma once

#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace mascot {

/// Where a viewer sends an agent, as a geometry_msgs/PoseStamped says it: frame_id, and position in W (m).
struct Goal {
  std::string frame_id;
  double x = 0, y = 0, z = 0;
};

/// Bytes as text, in the same place.
inline std::string_view TextOf(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Reads the little-endian fields of a message of unknown origin. Beyond its end everything is 0 and ok() is false.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : all_(bytes), rest_(bytes) {}
  bool ok() const { return ok_; }
  std::span<const std::uint8_t> rest() const { return rest_; }

  template <class T>
  T Take() {
    T value{};
    const auto bytes = TakeBytes(sizeof value);
    if (!bytes.empty()) std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }
  /// A u32 length, then this many bytes.
  std::string_view TakeText() { return TextOf(TakeBytes(Take<std::uint32_t>())); }
  /// Goes to the next multiple of `bytes`, counted from the beginning.
  void Align(std::size_t bytes) { TakeBytes((bytes - (all_.size() - rest_.size()) % bytes) % bytes); }
  std::span<const std::uint8_t> TakeBytes(std::size_t count) {
    if (count > rest_.size()) {
      ok_ = false;
      rest_ = {};
      return {};
    }
    const auto taken = rest_.first(count);
    rest_ = rest_.subspan(count);
    return taken;
  }

 private:
  std::span<const std::uint8_t> all_, rest_;
  bool ok_ = true;
};

/// Appends a number, little-endian.
template <class T>
void PutBytes(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Reads a geometry_msgs/msg/PoseStamped in cdr or json. Nullopt if the bytes are not one, or if numbers are not
/// finite.
std::optional<Goal> ReadGoal(std::string_view encoding, std::span<const std::uint8_t> message);

}  // namespace mascot
