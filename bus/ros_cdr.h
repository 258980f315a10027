#pragma once

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastcdr/exceptions/BadParamException.h>
#include <fastcdr/exceptions/Exception.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mascot::ros {

// Messages of ROS 2 as samples of DDS: four bytes of encapsulation, then CDR.

using Bytes = std::vector<std::uint8_t>;
using Cdr = eprosima::fastcdr::Cdr;

/// Reads fields one after the other. Throws eprosima::fastcdr::exception::Exception for a sample that ends too early.
class Fields {
 public:
  explicit Fields(std::span<const std::uint8_t> sample)
      : bytes_(sample.begin(), sample.end()),
        buffer_(reinterpret_cast<char*>(bytes_.data()), bytes_.size()),
        cdr_(buffer_, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR) {
    cdr_.read_encapsulation();
  }
  template <class T>
  T Next() {
    T value{};
    cdr_ >> value;
    return value;
  }
  /// std_msgs/Header.
  void Header() {
    Next<std::int32_t>();
    Next<std::uint32_t>();
    Next<std::string>();
  }
  /// The elements of a sequence, each by `next()`; throws for one of more than `most`.
  template <class Next>
  auto Sequence(std::uint32_t most, const Next& next) {
    std::vector<decltype(next())> elements;
    const auto count = this->Next<std::uint32_t>();
    if (count > most) throw eprosima::fastcdr::exception::BadParamException("too long a sequence");
    for (std::uint32_t k = 0; k < count; ++k) elements.push_back(next());
    return elements;
  }
  /// builtin_interfaces/Duration (s).
  double Duration() {
    const auto seconds = Next<std::int32_t>();
    return seconds + 1e-9 * Next<std::uint32_t>();
  }
  /// geometry_msgs/Point and Vector3.
  Eigen::Vector3d Vector() {
    Eigen::Vector3d vector;
    for (double& x : vector) cdr_ >> x;
    return vector;
  }
  Eigen::Quaterniond Quaternion() {
    Eigen::Quaterniond q;
    for (double& x : q.coeffs()) cdr_ >> x;  // x, y, z, w
    return q;
  }

 private:
  Bytes bytes_;
  eprosima::fastcdr::FastBuffer buffer_;
  Cdr cdr_;
};

/// What `read` makes of a sample; nothing if that ends too early, or is no such message.
template <class Message, class Read>
std::optional<Message> ReadAs(std::span<const std::uint8_t> sample, const Read& read) try {
  Fields fields(sample);
  return read(fields);
} catch (const eprosima::fastcdr::exception::Exception&) {
  return std::nullopt;
}

/// The sample that `write` puts together, of at most `longest` bytes. What is between fields is 0: Fast CDR itself
/// leaves there what was in memory.
template <class Write>
Bytes Written(const Write& write, std::size_t longest = 1024) {
  Bytes bytes(longest, 0);
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(bytes.data()), bytes.size());
  Cdr cdr(buffer, Cdr::LITTLE_ENDIANNESS, Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  write(cdr);
  bytes.resize(cdr.getSerializedDataLength());
  return bytes;
}

/// std_msgs/Header, with no time.
inline void WriteHeader(Cdr& cdr, std::string_view frame) {
  cdr << std::int32_t{0} << std::uint32_t{0} << std::string(frame);
}
/// geometry_msgs/Point and Vector3.
inline void Write(Cdr& cdr, const Eigen::Vector3d& vector) { cdr << vector.x() << vector.y() << vector.z(); }

}  // namespace mascot::ros
