#pragma once

#include <algorithm>
#include <cstdint>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <functional>
#include <string>
#include <vector>

namespace mascot {

/// Has the name of a type, so that it matches that type's readers and writers, but keeps the bytes of samples, of any
/// length, as they are: four of encapsulation, then CDR (std::vector<std::uint8_t>).
class RawType : public eprosima::fastdds::dds::TopicDataType {
 public:
  using Bytes = std::vector<std::uint8_t>;
  using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;

  explicit RawType(const std::string& name) {
    setName(name.c_str());
    m_typeSize = 256;  // a first guess for preallocation; histories grow with what comes
    m_isGetKeyDefined = false;
  }
  bool serialize(void* data, Payload* payload) override {
    const auto& bytes = *static_cast<Bytes*>(data);
    if (bytes.size() > payload->max_size) return false;
    std::ranges::copy(bytes, payload->data);
    payload->length = static_cast<std::uint32_t>(bytes.size());
    payload->encapsulation = CDR_LE;
    return true;
  }
  bool deserialize(Payload* payload, void* data) override {
    static_cast<Bytes*>(data)->assign(payload->data, payload->data + payload->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<Bytes*>(data)->size()); };
  }
  void* createData() override { return new Bytes; }
  void deleteData(void* data) override { delete static_cast<Bytes*>(data); }
  bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
};

}  // namespace mascot
