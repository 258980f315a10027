#pragma once

#include <fastcdr/exceptions/Exception.h>
#include <fastdds/rtps/common/SerializedPayload.h>

#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <vector>

namespace mascot {

/// A fastddsgen type whose padding bytes are zero on the wire. Fast CDR leaves old memory in them, which would make
/// recordings differ from run to run.
template <class PubSub>
class ZeroPadded : public PubSub {
 public:
  bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override {
    std::memset(payload->data, 0, payload->max_size);
    return PubSub::serialize(data, payload);
  }
};

/// The size of a sample as RTPS sends it: up to the next multiple of 4.
constexpr std::uint32_t PaddedSize(std::uint32_t size) { return (size + 3) / 4 * 4; }

/// A type as our participants register it. Samples that they write are ZeroPadded, and end at a multiple of 4 bytes:
/// Fast DDS sees to that itself only if it sends a sample in one piece, and not in fragments. Samples that they receive
/// stay bytes (a std::vector<std::uint8_t>) until it is known which process sent them.
template <class PubSub>
class WireType : public ZeroPadded<PubSub> {
 public:
  bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override {
    if (!ZeroPadded<PubSub>::serialize(data, payload)) return false;
    payload->length = PaddedSize(payload->length);
    return payload->length <= payload->max_size;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] {  // no copy of PubSub's function: it would take memory at each sample
      const auto& sample = *static_cast<const typename PubSub::type*>(data);
      const std::size_t body = PubSub::type::getCdrSerializedSize(sample);
      return PaddedSize(static_cast<std::uint32_t>(body) + 4);  // with the encapsulation
    };
  }
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* bytes) override {
    static_cast<std::vector<std::uint8_t>*>(bytes)->assign(payload->data, payload->data + payload->length);
    return true;
  }
};

/// Where samples of a type hold the number of elements of their only sequence, and the fewest bytes that an element
/// takes; 0, 0 for types without a sequence. Specialised in bus/wire.h.
template <class PubSub>
struct SequenceOf {
  static constexpr std::size_t kAt = 0, kElement = 0;
};

/// Whether `bytes` can hold as many elements as they say. Fast CDR would reserve memory for that number unseen.
template <class PubSub>
bool HoldsItsSequence(std::span<const std::uint8_t> bytes) {
  using Sequence = SequenceOf<PubSub>;
  if constexpr (Sequence::kElement == 0) return true;
  std::uint32_t count = 0;
  if (bytes.size() < Sequence::kAt + sizeof count) return false;
  std::memcpy(&count, bytes.data() + Sequence::kAt, sizeof count);
  return count * std::uint64_t{Sequence::kElement} <= bytes.size();
}

/// Decodes a sample from `bytes`: a 4-byte encapsulation header, then CDR. Returns false if `bytes` is not such a
/// sample.
template <class PubSub>
bool Decode(std::span<const std::uint8_t> bytes, typename PubSub::type& sample) {
  if (!HoldsItsSequence<PubSub>(bytes)) return false;
  thread_local PubSub type;
  eprosima::fastrtps::rtps::SerializedPayload_t payload;  // borrows the bytes: reset below, or it would free them
  payload.data = const_cast<std::uint8_t*>(bytes.data());
  payload.length = payload.max_size = static_cast<std::uint32_t>(bytes.size());
  bool ok = false;
  try {
    ok = type.deserialize(&payload, &sample);
  } catch (const eprosima::fastcdr::exception::Exception&) {  // for an encapsulation that it does not know
  }
  payload.data = nullptr;
  payload.length = payload.max_size = 0;
  return ok;
}

}  // namespace mascot
