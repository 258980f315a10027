#include "orchestrator/engines/dds/row_player.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "base/number.h"
#include "bus/addresses.h"
#include "bus/resources.h"
#include "system/failure.h"

namespace mascot {
namespace {

using namespace std::chrono_literals;

/// How long a listener that has not confirmed samples may keep the next ones back.
constexpr auto kPatienceWithListeners = 2s;
constexpr auto kTimeForTheLast = 2s;

}  // namespace

RowPlayer::RowPlayer(const McapContents& contents, const Options& options, Console& console, StopSignal& stop)
    : contents_(contents), options_(options), console_(console), stop_(stop) {}

RowPlayer::Result RowPlayer::Play() {
  try {
    Join();
    if (AwaitListeners()) PlaySamples();
  } catch (const std::exception& failure) {
    result_.failure = InWords(failure);
  }
  console_.EndProgress();
  return result_;
}

void RowPlayer::Join() {
  own_domain_.emplace(options_.wanted_domain);
  DomainOptions options;
  options.domain = own_domain_->domain();
  options.transport = options_.transport;
  options.name = "replay";
  options.loopback = true;  // as a run on this host
  options.participants = 8;
  RequireAddresses(options);
  RequireResources({.shared_memory = SharedMemoryNeeded(options)});
  domain_.emplace(options, [this] { stop_.Wake(); });
  for (const auto& [id, channel] : contents_.channels)
    if (const auto topic = Topic::Parse(channel.topic))
      writers_.emplace(std::piecewise_construct, std::forward_as_tuple(id),
                       std::forward_as_tuple(*domain_, *topic, Redelivery::kAlways));
  console_.Line(
      fmt::format("DDS domain {} (ROS_DOMAIN_ID={}), {} topics", options.domain, options.domain, writers_.size()));
}

/// Returns false if a signal came first.
bool RowPlayer::AwaitListeners() {
  std::vector<std::string> missing = options_.await;
  const auto is_read = [this](const std::string& name) {
    return std::ranges::any_of(writers_, [&](const auto& writer) {
      return contents_.channels.at(writer.first).topic == name && writer.second.matched() > 0;
    });
  };
  std::erase_if(missing, is_read);
  if (!missing.empty()) console_.Line("waiting for somebody who listens to " + missing.front());
  while (!missing.empty()) {
    result_.signal = stop_.Within(100ms);
    if (result_.signal != 0) return false;
    std::erase_if(missing, is_read);
  }
  return true;
}

/// Returns false if a signal came first.
bool RowPlayer::WaitUntil(Clock::time_point time) {
  for (auto left = time - Clock::now(); left > left.zero(); left = time - Clock::now()) {
    result_.signal = stop_.Within(left);
    if (result_.signal != 0) return false;
  }
  return true;
}

/// Lets reliable listeners confirm what was published: a writer keeps its last samples only. Returns false if a signal
/// came first.
bool RowPlayer::LetListenersCatchUp() {
  const auto deadline = Clock::now() + kPatienceWithListeners;
  for (auto& [id, writer] : writers_) {
    while (!writer.AwaitReaders(20ms)) {
      result_.signal = stop_.Within(0ms);
      if (result_.signal != 0) return false;
      if (Clock::now() < deadline) continue;
      if (!std::exchange(said_slow_, true))
        console_.Warning("warning: a listener to " + contents_.channels.at(id).topic +
                         " does not keep up, and may miss samples");
      return true;
    }
  }
  return true;
}

void RowPlayer::PlaySamples() {
  McapReader reader(options_.file);
  auto begin = Clock::now();
  std::uint64_t end_ns = 0;
  for (const auto& [id, channel] : contents_.channels) end_ns = std::max(end_ns, channel.last_time);
  std::map<std::uint16_t, int> unconfirmed;  // by channel, an upper limit
  std::uint64_t time_ns = 0;
  // We know of readers that may not know of our writers yet: another vendor's learns of them a second later, and misses
  // what they have sent by then. Those that are reliable confirm the first samples once they do.
  bool is_heard = false;
  while (const McapContents::Message* sample = reader.Next()) {
    const auto writer = writers_.find(sample->channel);
    if (writer == writers_.end()) continue;
    if (sample->log_time != time_ns) {
      if (!std::exchange(is_heard, true)) {
        const auto since = Clock::now();
        if (!LetListenersCatchUp()) return;
        begin += Clock::now() - since;
      }
      time_ns = sample->log_time;
      const double time_s = static_cast<double>(time_ns) * 1e-9;
      if (options_.speed > 0 && !WaitUntil(begin + std::chrono::duration_cast<Clock::duration>(
                                                       std::chrono::duration<double>(time_s / options_.speed))))
        return;
      result_.signal = stop_.Within(0ms);
      if (result_.signal != 0) return;
      console_.Progress(end_ns == 0 ? 1 : static_cast<double>(time_ns) / static_cast<double>(end_ns),
                        ShortestFloat(time_s) + " s");
    }
    const int kept = Topic::Parse(contents_.channels.at(sample->channel).topic)->traits().writer_depth;
    if (options_.speed == 0 && ++unconfirmed[sample->channel] > std::max(1, kept / 2)) {
      if (!LetListenersCatchUp()) return;
      unconfirmed.clear();
      ++unconfirmed[sample->channel];
    }
    RawWriter::Bytes bytes = sample->data;
    writer->second.Write(bytes);
    ++result_.samples;
    result_.recorded_s = static_cast<double>(time_ns) * 1e-9;
  }
  const auto deadline = Clock::now() + kTimeForTheLast;
  for (auto& [id, writer] : writers_)  // its shared memory goes with this process
    while (!writer.AwaitReaders(20ms) && Clock::now() < deadline)
      if (result_.signal = stop_.Within(0ms); result_.signal != 0) return;
}

bool RowPlayer::End() {
  if (std::exchange(ended_, true) || !own_domain_) return let_go_;
  try {
    let_go_ = own_domain_->Leave(
        [this] {
          writers_.clear();
          domain_.reset();
        },
        stop_);
  } catch (const std::exception& failure) {
    console_.Line(InWords(failure));
  }
  return let_go_;
}

}  // namespace mascot
