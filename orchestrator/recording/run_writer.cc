#include "orchestrator/recording/run_writer.h"

#include <map>

#include "bus/qos.h"
#include "bus/wire.h"
#include "experiment/read_experiment.h"
#include "idl/schemas.h"
#include "idl/topics.h"
#include "orchestrator/recording/completeness.h"
#include "orchestrator/recording/fingerprint.h"
#include "orchestrator/recording/topic_filter.h"

namespace mascot {
RunWriter::RunWriter(const Experiment& experiment, const RunFolder& folder, const std::string& without_events)
    : experiment_(experiment), mcap_(folder.File(experiment.record.file)), arrays_(experiment.size()) {
  mcap_.Attach(kExperimentFile, kToml, without_events);
  std::map<std::string, std::string> about = Fingerprints(experiment);
  about[kFormatKey] = std::to_string(kFormat);
  mcap_.Metadata(kMetadata, about);
  for (int id = 1; id <= experiment.size(); ++id) {
    actions_.push_back(experiment.agent(id).takes_actions ? AddChannel(Topic::Action(id)) : std::nullopt);
    commands_.push_back(AddChannel(Topic::Command(id)));
    messages_.push_back(experiment.agent(id).sends_messages ? AddChannel(Topic::Message(id)) : std::nullopt);
    states_.push_back(AddChannel(Topic::State(id)));
  }
  clock_ = AddChannel(Topic::Clock());
  event_ = AddChannel(Topic::Event());
  if (experiment.record.ros_types) {  // last: the other channels keep their numbers
    ros_ = std::make_unique<Ros>(experiment);
    for (int id = 1; id <= experiment.size(); ++id) ros_->odometry.push_back(AddChannel(Topic::Odom(id)));
    ros_->scene = AddChannel(Topic::Scene());
    ros_->tf = AddChannel(Topic::Tf());
  }
  if (experiment.output.save_data || experiment.output.wants_pictures())  // which are made of it
    npz_.emplace(folder.File("states.npz"), experiment.size(),
                 RecordedTicks(experiment.ticks() + 1, experiment.ticks_per_row()).rows());
  if (experiment.ticks_per_row() > 1) kept_.emplace(experiment);
}

std::optional<std::uint16_t> RunWriter::AddChannel(const Topic& topic) {
  const std::string name = topic.Name();
  if (!IsRecorded(experiment_.record.topics, topic)) return std::nullopt;
  const TypeSchema& schema = SchemaOf(topic.kind);
  ++topics_;
  return mcap_.AddChannel(
      {name,
       std::string(schema.name),
       std::string(schema.text),
       {{"offered_qos_profiles", OfferedQos(topic.traits())}, {"topic_type_hash", std::string(schema.type_hash)}}});
}

void RunWriter::WriteRos(std::optional<std::uint16_t> channel, const Topic& topic, std::uint64_t time_ns) {
  if (channel) WriteSample(channel, time_ns, ros_->rows.Message(topic));
}

void RunWriter::WriteSample(std::optional<std::uint16_t> channel, std::uint64_t time_ns, const Row::Bytes& bytes) {
  if (channel && !bytes.empty()) mcap_.Write(*channel, time_ns, bytes);
}

void RunWriter::Add(const FlownRow& row) {
  if (kept_ && kept_->has_row && !kept_->row.decoded.events.empty()) {  // a row that is left out: it was not the last
    WriteEvents(KeptAsFlown(kept_->row, kept_->encoder));
    mcap_.EndTick();
  }
  ++ticks_;
  const bool is_kept = row.tick() % experiment_.ticks_per_row() != 0;
  if (kept_) kept_->has_row = is_kept;
  if (is_kept)
    kept_->row.Keep(row);
  else
    WriteRow(row);
}

void RunWriter::WriteRow(const FlownRow& row) {
  const Row& bytes = row.bytes();
  const std::uint64_t time_ns = StampNs(row.tick(), experiment_.control.rate_hz);
  if (ros_) ros_->rows.SetRow(row);
  for (std::size_t i = 0; i < bytes.states.size(); ++i) {
    WriteSample(actions_[i], time_ns, bytes.actions[i]);
    WriteSample(commands_[i], time_ns, bytes.commands[i]);
    WriteSample(messages_[i], time_ns, bytes.messages[i]);
    if (ros_) WriteRos(ros_->odometry[i], Topic::Odom(static_cast<int>(i) + 1), time_ns);
    WriteSample(states_[i], time_ns, bytes.states[i]);
  }
  WriteSample(clock_, time_ns, bytes.clock);
  WriteEvents(row);
  if (ros_) {
    WriteRos(ros_->scene, Topic::Scene(), time_ns);
    WriteRos(ros_->tf, Topic::Tf(), time_ns);
  }
  mcap_.EndTick();
  if (npz_) {
    arrays_.Set(experiment_.time_s(row.tick()), row.decoded());
    npz_->Append(arrays_);
  }
  ++rows_;
}

void RunWriter::WriteEvents(const FlownRow& row) {
  const std::uint64_t time_ns = StampNs(row.tick(), experiment_.control.rate_hz);
  for (const Row::Bytes& event : row.bytes().events) WriteSample(event_, time_ns, event);
}

void RunWriter::Close(const std::string& config) {
  if (kept_ && kept_->has_row) WriteRow(KeptAsFlown(kept_->row, kept_->encoder));
  if (ticks_ <= experiment_.ticks()) mcap_.Metadata(kEarlyEnd, {{kTicksKey, std::to_string(ticks_)}});
  mcap_.Attach(kConfigFile, kToml, config);
  mcap_.Close();
  if (npz_) npz_->Close();
}

}  // namespace mascot
