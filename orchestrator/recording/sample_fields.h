#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "idl/topics.h"

namespace mascot {

/// Where two samples differ.
struct SampleDifference {
  std::string field;  ///< "pose.position.x", as in the message definition; "byte 37" if no field differs; "size"
  std::string first, second;  ///< the values of the field; a number reads back as the same bits
};

/// The first field in which two samples of a per-tick topic of this kind differ; nothing if their bytes are equal.
std::optional<SampleDifference> FirstDifference(TopicKind kind, std::span<const std::uint8_t> first,
                                                std::span<const std::uint8_t> second);

}  // namespace mascot
