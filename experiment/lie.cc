#include "experiment/lie.h"

namespace mascot {

std::span<const Key> LieKeys() {
  static const Key keys[] = {
      key::OneOf("kind", kLieKinds.names(),
                 "constant: off by offset_m; oscillating: by a sine of that amplitude; random: by up to that, anew at "
                 "each tick")
          .Default("\"constant\""),
      key::Number("from_s", {0, 1e6}, "it tells the truth before").Default("0.0"),
      key::Vector3("offset_m", {-1e6, 1e6}, "how far off its position is in what others hear").Required(),
      key::Number("period_s", Above(0, 1e6), "of an oscillating lie").Default("5.0"),
  };
  return keys;
}

LieConfig ReadLie(Section& lie) {
  LieConfig config{.kind = kLieKinds.Value(lie.OneOf("kind")),
                   .from_s = lie.Number("from_s"),
                   .offset_m = lie.Vector3("offset_m"),
                   .period_s = lie.Number("period_s")};
  lie.Done();
  return config;
}

}  // namespace mascot
