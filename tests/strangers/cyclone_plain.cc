// cyclone_plain DOMAIN TOPIC...: reads topics of a run by Eclipse Cyclone DDS, over 127.0.0.1, with types that idlc has
// made of the plain IDL, and prints every sample, a line of JSON each, until it is killed.
#include <dds/dds.h>

#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "mascot.h"

namespace {

using Json = nlohmann::json;

Json Numbers(const mascot_msgs_msg_dds__AgentState_& state) {
  const auto& p = state.pose.position;
  const auto& q = state.pose.orientation;
  const auto& v = state.twist.linear;
  const auto& w = state.twist.angular;
  const auto& a = state.acceleration;
  return {p.x, p.y, p.z, q.x, q.y, q.z, q.w, v.x, v.y, v.z, w.x, w.y, w.z, a.x, a.y, a.z};
}

Json Numbers(const mascot_msgs_msg_dds__AgentCommand_& command) {
  const auto& u = command.actuator;
  const auto& wanted = command.acceleration_wanted;
  const auto& limited = command.acceleration_limited;
  return {u[0], u[1], u[2], u[3], wanted.x, wanted.y, wanted.z, limited.x, limited.y, limited.z};
}

template <class OfAgent>
Json Seen(const OfAgent& sample) {
  return {{"sec", sample.stamp.sec},
          {"nanosec", sample.stamp.nanosec},
          {"tick", sample.tick},
          {"agent", sample.agent},
          {"numbers", Numbers(sample)}};
}

Json Seen(const rosgraph_msgs_msg_dds__Clock_& clock) {
  return {{"sec", clock.clock.sec}, {"nanosec", clock.clock.nanosec}};
}

Json Seen(const mascot_msgs_msg_dds__TickRow_& row) {
  Json states = Json::array(), commands = Json::array();
  for (std::uint32_t k = 0; k < row.states._length; ++k) states.push_back(Seen(row.states._buffer[k]));
  for (std::uint32_t k = 0; k < row.commands._length; ++k) commands.push_back(Seen(row.commands._buffer[k]));
  return {{"tick", row.tick}, {"states", states}, {"commands", commands}};
}

Json Seen(const mascot_msgs_msg_dds__Experiment_& experiment) {
  return {{"name", experiment.name}, {"toml", experiment.toml}};
}

/// A topic that is read, and what prints its samples.
struct Reading {
  dds_entity_t reader;
  std::string topic;
  void (*print)(const Reading&);
};

template <class Sample>
void Print(const Reading& reading) {
  void* sample = nullptr;
  dds_sample_info_t info;
  while (dds_take(reading.reader, &sample, &info, 1, 1) > 0) {
    if (info.valid_data) {
      Json seen = Seen(*static_cast<const Sample*>(sample));
      seen["topic"] = reading.topic;
      std::cout << seen.dump() << std::endl;
    }
    dds_return_loan(reading.reader, &sample, 1);
  }
}

/// The topic, read as the profiles "ticks" and "latest" of idl/profiles/qos.xml say.
Reading Read(dds_entity_t participant, const std::string& name) {
  const std::string last = name.substr(name.rfind('/') + 1);
  const bool latest = last == "experiment";
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_durability(qos, latest ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, latest ? 1 : 128);
  const auto read = [&](const dds_topic_descriptor_t& type, void (*print)(const Reading&)) {
    const dds_entity_t topic = dds_create_topic(participant, &type, name.c_str(), nullptr, nullptr);
    return Reading{dds_create_reader(participant, topic, qos, nullptr), name, print};
  };
  Reading reading{-1, name, nullptr};
  if (last == "state")
    reading = read(mascot_msgs_msg_dds__AgentState__desc, Print<mascot_msgs_msg_dds__AgentState_>);
  else if (last == "command")
    reading = read(mascot_msgs_msg_dds__AgentCommand__desc, Print<mascot_msgs_msg_dds__AgentCommand_>);
  else if (last == "row")
    reading = read(mascot_msgs_msg_dds__TickRow__desc, Print<mascot_msgs_msg_dds__TickRow_>);
  else if (last == "experiment")
    reading = read(mascot_msgs_msg_dds__Experiment__desc, Print<mascot_msgs_msg_dds__Experiment_>);
  else if (last == "clock")
    reading = read(rosgraph_msgs_msg_dds__Clock__desc, Print<rosgraph_msgs_msg_dds__Clock_>);
  dds_delete_qos(qos);
  return reading;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  setenv("CYCLONEDDS_URI", "<General><Interfaces><NetworkInterface name='lo' multicast='true'/></Interfaces></General>",
         1);
  const dds_entity_t participant =
      dds_create_participant(static_cast<dds_domainid_t>(std::atoi(argv[1])), nullptr, nullptr);
  const dds_entity_t news = dds_create_waitset(participant);
  std::vector<Reading> readings;
  for (int k = 2; k < argc; ++k) {
    readings.push_back(Read(participant, argv[k]));
    if (readings.back().reader < 0) {
      std::cerr << "cannot read " << argv[k] << std::endl;
      return 1;
    }
    dds_set_status_mask(readings.back().reader, DDS_DATA_AVAILABLE_STATUS);
    dds_waitset_attach(news, readings.back().reader, 0);
  }
  for (;;) {
    dds_waitset_wait(news, nullptr, 0, DDS_INFINITY);
    for (const Reading& reading : readings) reading.print(reading);
  }
}
