#include "orchestrator/engines/dds/ros_publisher.h"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <utility>

namespace mascot {
namespace {

using namespace std::chrono_literals;

constexpr auto kTfPeriod = 20ms, kScenePeriod = 100ms;
constexpr double kMaxBytesPerSecond = 5e6;  // of a topic

RosPublisher::Clock::duration TimeToSend(std::size_t bytes) {
  const std::chrono::duration<double> time(static_cast<double>(bytes) / kMaxBytesPerSecond);
  return std::chrono::duration_cast<RosPublisher::Clock::duration>(time);
}

}  // namespace

RosPublisher::RosPublisher(const DomainOptions& options, RosSource& source, std::function<void(const std::string&)> log,
                           eprosima::fastdds::dds::DomainParticipantListener* discovery)
    : source_(source),
      log_(std::move(log)),
      domain_(
          options, [] {}, nullptr, discovery),
      tf_{.writer = {domain_, Topic::Tf()}, .period = kTfPeriod},
      scene_{.writer = {domain_, Topic::Scene()}, .period = kScenePeriod},
      thread_([this](const std::stop_token& over) { Run(over); }) {}

void RosPublisher::Run(const std::stop_token& over) try {
  std::mutex mutex;
  std::condition_variable_any never;
  for (std::unique_lock lock(mutex); !over.stop_requested();
       never.wait_for(lock, over, kTfPeriod, [] { return false; })) {
    if (tf_.writer.matched() + scene_.writer.matched() == 0) continue;
    const std::int64_t tick = source_.TakeNewest();
    if (tick < 0) continue;
    Show(tf_, tick, &RosSource::Transforms);
    Show(scene_, tick, &RosSource::Scene);
  }
} catch (const std::exception& failure) {
  log_(std::string("ros_view: it has ended because of an error of ours, and nothing else has: ") + failure.what());
}

void RosPublisher::Show(Shown& topic, std::int64_t tick, RosSource::Bytes (RosSource::*make)() const) {
  const int readers = topic.writer.matched();
  if (readers > topic.readers) topic.pending = 2;
  topic.readers = readers;
  const auto now = Clock::now();
  if (readers == 0 || now < topic.next) return;
  const bool pays = topic.pending == 2 || (topic.pending == 1 && topic.writer.AwaitReaders(0ms));
  if (!pays && tick == topic.tick) return;
  if (pays) --topic.pending;
  RosSource::Bytes sample = (source_.*make)();
  topic.tick = tick;
  topic.next = now + std::max(topic.period, TimeToSend(sample.size()));
  try {
    topic.writer.Write(sample);
  } catch (const BusError&) {  // another follows
  }
}

}  // namespace mascot
