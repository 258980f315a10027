#pragma once

#include <cstdint>

#include "orchestrator/recording/row_codec.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// A row that is kept beyond the call of Add(): what came over the wire, or what is to be encoded. It keeps its
/// capacity.
struct KeptRow {
  explicit KeptRow(int agents) : decoded(agents), received(agents) {}

  void Keep(const FlownRow& row) {
    tick = row.tick();
    decoded = row.decoded();
    const Row* const bytes = row.received();
    is_received = bytes != nullptr;
    if (is_received) received = *bytes;
  }

  std::int64_t tick = 0;
  DecodedRow decoded;
  bool is_received = false;
  Row received;
};

/// A row that was kept, for a sink.
class KeptAsFlown final : public FlownRow {
 public:
  /// Both must outlive this object.
  KeptAsFlown(const KeptRow& row, RowEncoder& encoder) : row_(row), encoder_(encoder) {}
  std::int64_t tick() const override { return row_.tick; }
  const DecodedRow& decoded() const override { return row_.decoded; }
  const Row& bytes() const override {
    if (row_.is_received) return row_.received;
    if (encoded_ == nullptr) encoded_ = &encoder_.Encode(row_.tick, row_.decoded);
    return *encoded_;
  }
  const Row* received() const override { return row_.is_received ? &row_.received : nullptr; }

 private:
  const KeptRow& row_;
  RowEncoder& encoder_;
  mutable const Row* encoded_ = nullptr;
};

}  // namespace mascot
