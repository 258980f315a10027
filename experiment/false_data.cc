#include "experiment/false_data.h"

namespace mascot {

std::span<const Key> FalseDataKeys() {
  static const Key keys[] = {
      key::OneOf("kind", kFalseDataKinds.names(),
                 "constant: the position is off by offset_m; oscillating: by a sine of this amplitude; random: by up "
                 "to this, drawn anew at each tick")
          .Default("\"constant\""),
      key::Number("from_s", {0, 1e6}, "before this time the agent tells the truth").Default("0.0"),
      key::Vector3("offset_m", {-1e6, 1e6}, "how far off the position is that others hear of the agent").Required(),
      key::Number("period_s", Above(0, 1e6), "period of an oscillating lie").Default("5.0"),
  };
  return keys;
}

FalseDataConfig ReadFalseData(Section& lie) {
  FalseDataConfig config{.kind = kFalseDataKinds.Value(lie.OneOf("kind")),
                         .from_s = lie.Number("from_s"),
                         .offset_m = lie.Vector3("offset_m"),
                         .period_s = lie.Number("period_s")};
  lie.Done();
  return config;
}

}  // namespace mascot
