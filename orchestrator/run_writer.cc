#include "orchestrator/run_writer.h"

#include <fnmatch.h>

#include <algorithm>

#include "idl/qos.h"
#include "idl/schemas.h"
#include "idl/topics.h"
#include "idl/wire.h"

namespace mascot {
namespace {

std::string_view SchemaName(TopicKind kind) {
  switch (kind) {
    case TopicKind::kCommand:
      return "mascot_msgs/msg/AgentCommand";
    case TopicKind::kState:
      return "mascot_msgs/msg/AgentState";
    default:
      return "rosgraph_msgs/msg/Clock";
  }
}

bool IsWanted(const std::vector<std::string>& patterns, const std::string& topic) {
  return std::any_of(patterns.begin(), patterns.end(),
                     [&](const std::string& pattern) { return fnmatch(pattern.c_str(), topic.c_str(), 0) == 0; });
}

/// The arrays of states.npz that grow, in the order of the file; each with its width per agent.
enum ArrayName { kTime, kPosition, kVelocity, kOrientation, kAngularVelocity, kAccelerationCommand, kActuator };
struct ArrayRow {
  const char* name;
  std::size_t width;  // 0: one number a row
};
constexpr ArrayRow kArrays[] = {
    {"t", 0},           {"position", 3},         {"velocity", 3},
    {"orientation", 4}, {"angular_velocity", 3}, {"acceleration_command", 3},
    {"actuator", 4},
};

}  // namespace

RunWriter::RunWriter(Experiment& experiment, const RunFolder& folder, const std::string& resolved)
    : experiment_(experiment), mcap_(folder.File(experiment.record.file)), metrics_(experiment) {
  mcap_.Attach("config.toml", "application/toml", resolved);
  for (int id = 1; id <= experiment.size(); ++id) {
    commands_.push_back(AddChannel(Topic::Command(id)));
    states_.push_back(AddChannel(Topic::State(id)));
  }
  clock_ = AddChannel(Topic::Clock());
  const auto agents = static_cast<std::size_t>(experiment.size());
  motion_.resize(agents);
  command_.resize(agents);
  if (!experiment.output.save_data && !experiment.output.save_plot) return;
  npz_.emplace(folder.File("states.npz"));
  for (const ArrayRow& row : kArrays) {
    if (row.name == std::string_view("position")) {
      std::vector<std::int64_t> ids;
      for (const AgentConfig& agent : experiment.agents) ids.push_back(agent.id);
      npz_->AddConstant("id", ids);
    }
    const std::vector<std::size_t> shape = row.width == 0 ? std::vector<std::size_t>{} : std::vector{agents, row.width};
    arrays_.push_back({npz_->AddArray(row.name, shape), std::vector<double>(row.width == 0 ? 1 : agents * row.width)});
  }
}

std::optional<std::uint16_t> RunWriter::AddChannel(const Topic& topic) {
  const std::string name = topic.Name();
  if (!IsWanted(experiment_.record.topics, name)) return std::nullopt;
  const TypeSchema& schema = SchemaOf(SchemaName(topic.kind));
  ++topics_;
  return mcap_.AddChannel({name,
                           std::string(schema.name),
                           std::string(schema.text),
                           {{"offered_qos_profiles", OfferedQos(WriterDepth(topic.kind))},
                            {"topic_type_hash", std::string(schema.type_hash)}}});
}

void RunWriter::WriteSample(std::optional<std::uint16_t> channel, std::uint64_t time_ns, const Row::Bytes& bytes) {
  if (channel && !bytes.empty()) mcap_.Write(*channel, time_ns, bytes);
}

void RunWriter::Add(const Row& row) {
  const std::uint64_t time_ns = StampNs(row.tick, experiment_.control.rate_hz);
  mascot_msgs::msg::AgentState state;
  mascot_msgs::msg::AgentCommand command;
  for (std::size_t i = 0; i < motion_.size(); ++i) {
    WriteSample(commands_[i], time_ns, row.commands[i]);
    WriteSample(states_[i], time_ns, row.states[i]);
    Deserialize(row.states[i], state);
    motion_[i] = FromWire(state);
    if (row.commands[i].empty()) continue;  // held
    Deserialize(row.commands[i], command);
    command_[i] = FromWire(command);
  }
  WriteSample(clock_, time_ns, row.clock);
  mcap_.EndTick();
  if (npz_) WriteArrays(experiment_.time_s(row.tick));
  metrics_.Add(motion_, command_);
  ++rows_;
}

void RunWriter::WriteArrays(double t_s) {
  auto put = [this](ArrayName array, std::size_t agent, const auto& values, std::size_t width) {
    for (std::size_t k = 0; k < width; ++k) arrays_[array].row[agent * width + k] = values[k];
  };
  arrays_[kTime].row[0] = t_s;
  for (std::size_t i = 0; i < motion_.size(); ++i) {
    const Motion& motion = motion_[i];
    const double wxyz[] = {motion.q_WB.w(), motion.q_WB.x(), motion.q_WB.y(), motion.q_WB.z()};
    put(kPosition, i, motion.p_WB, 3);
    put(kVelocity, i, motion.v_WB, 3);
    put(kOrientation, i, wxyz, 4);
    put(kAngularVelocity, i, motion.w_WB_B, 3);
    put(kAccelerationCommand, i, command_[i].a_limited_W, 3);
    put(kActuator, i, command_[i].actuator, 4);
  }
  for (const Array& array : arrays_) npz_->Append(array.handle, array.row);
}

void RunWriter::Close() {
  mcap_.Close();
  if (npz_) npz_->Close();
}

}  // namespace mascot
