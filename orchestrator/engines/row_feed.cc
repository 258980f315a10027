#include "orchestrator/engines/row_feed.h"

#include <utility>

#include "agent/laws/laws.h"

namespace mascot {
namespace {

class FromTheWire final : public FlownRow {
 public:
  FromTheWire(const Row& bytes, const DecodedRow& decoded) : bytes_(bytes), decoded_(decoded) {}
  std::int64_t tick() const override { return bytes_.tick; }
  const DecodedRow& decoded() const override { return decoded_; }
  const Row& bytes() const override { return bytes_; }
  const Row* received() const override { return &bytes_; }

 private:
  const Row& bytes_;
  const DecodedRow& decoded_;
};

class FromThisProcess final : public FlownRow {
 public:
  FromThisProcess(std::int64_t tick, const DecodedRow& decoded, RowEncoder& encoder)
      : tick_(tick), decoded_(decoded), encoder_(encoder) {}
  std::int64_t tick() const override { return tick_; }
  const DecodedRow& decoded() const override { return decoded_; }
  const Row& bytes() const override {
    if (bytes_ == nullptr) bytes_ = &encoder_.Encode(tick_, decoded_);
    return *bytes_;
  }
  const Row* received() const override { return nullptr; }

 private:
  std::int64_t tick_;
  const DecodedRow& decoded_;
  RowEncoder& encoder_;
  mutable const Row* bytes_ = nullptr;
};

}  // namespace

RowFeed::RowFeed(const Experiment& experiment, std::vector<RowSink*> sinks)
    : sinks_(std::move(sinks)), decoded_(experiment.size()), encoder_(experiment), experiment_(experiment) {}

void RowFeed::Add(const Row& bytes) {
  Decode(bytes, decoded_);
  HandOut(FromTheWire(bytes, decoded_));
}

void RowFeed::Add(std::int64_t tick, const DecodedRow& decoded) { HandOut(FromThisProcess(tick, decoded, encoder_)); }

void RowFeed::OnVehicle(const VehicleNews& news) {
  for (RowSink* sink : sinks_) sink->OnVehicle(news);
}

void RowFeed::HandOut(const FlownRow& row) {
  events_.clear();
  for (const DecodedRow::RowEvent& event : row.decoded().events) {
    if (!live_) live_.emplace(experiment_, &LawTable(), /*checked=*/true);
    live_->Take(event.event);
    events_.push_back(event.event);
  }
  if (!events_.empty())
    for (RowSink* sink : sinks_) sink->Adopt(*live_, events_);
  for (RowSink* sink : sinks_) sink->Add(row);
}

}  // namespace mascot
