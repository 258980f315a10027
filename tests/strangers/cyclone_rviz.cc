// cyclone_rviz DOMAIN: reads /tf and /scene by Eclipse Cyclone DDS as RViz2 does, over 127.0.0.1, and prints what it
// sees, a line of JSON each, until it is killed: every writer that it discovers, and every sample.
#include <dds/dds.h>

#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "rviz.h"

namespace {

using Json = nlohmann::json;

Json Seen(const dds_builtintopic_endpoint_t& writer) {
  void* data = nullptr;
  std::size_t size = 0;
  dds_qget_userdata(writer.qos, &data, &size);
  const std::string user_data(static_cast<const char*>(data), size);
  dds_free(data);
  dds_durability_kind_t durability{};
  dds_qget_durability(writer.qos, &durability);
  dds_reliability_kind_t reliability{};
  dds_qget_reliability(writer.qos, &reliability, nullptr);
  return {{"writes", writer.topic_name},
          {"type", writer.type_name},
          {"user_data", user_data},
          {"reliable", reliability == DDS_RELIABILITY_RELIABLE},
          {"latched", durability == DDS_DURABILITY_TRANSIENT_LOCAL}};
}

Json Seen(const tf2_msgs_msg_dds__TFMessage_& message) {
  Json transforms = Json::array();
  for (std::uint32_t i = 0; i < message.transforms._length; ++i) {
    const auto& [header, child, transform] = message.transforms._buffer[i];
    const auto& [p, q] = transform;
    transforms.push_back({{"stamp_ns", header.stamp.sec * 1'000'000'000LL + header.stamp.nanosec},
                          {"frame", header.frame_id},
                          {"child", child},
                          {"p", {p.x, p.y, p.z}},
                          {"q_xyzw", {q.x, q.y, q.z, q.w}}});
  }
  return {{"transforms", transforms}};
}

Json Seen(const visualization_msgs_msg_dds__MarkerArray_& message) {
  Json markers = Json::array();
  for (std::uint32_t i = 0; i < message.markers._length; ++i) {
    const auto& marker = message.markers._buffer[i];
    markers.push_back({{"ns", marker.ns},
                       {"id", marker.id},
                       {"type", marker.type},
                       {"frame", marker.header.frame_id},
                       {"locked", marker.frame_locked},
                       {"p", {marker.pose.position.x, marker.pose.position.y, marker.pose.position.z}},
                       {"scale", {marker.scale.x, marker.scale.y, marker.scale.z}},
                       {"points", marker.points._length},
                       {"text", marker.text}});
  }
  return {{"markers", markers}};
}

template <class Sample>
void Print(dds_entity_t reader) {
  void* sample = nullptr;
  dds_sample_info_t info;
  while (dds_take(reader, &sample, &info, 1, 1) > 0) {
    if (info.valid_data) std::cout << Seen(*static_cast<const Sample*>(sample)).dump() << std::endl;
    dds_return_loan(reader, &sample, 1);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  setenv("CYCLONEDDS_URI", "<General><Interfaces><NetworkInterface name='lo' multicast='true'/></Interfaces></General>",
         1);
  const dds_entity_t participant =
      dds_create_participant(static_cast<dds_domainid_t>(std::atoi(argv[1])), nullptr, nullptr);
  const auto read = [&](const dds_topic_descriptor_t& type, const char* name, dds_durability_kind_t durability) {
    dds_qos_t* qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
    dds_qset_durability(qos, durability);
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 100);
    const dds_entity_t topic = dds_create_topic(participant, &type, name, nullptr, nullptr);
    const dds_entity_t reader = dds_create_reader(participant, topic, qos, nullptr);
    dds_delete_qos(qos);
    return reader;
  };
  const dds_entity_t writers = dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr);
  const dds_entity_t tf = read(tf2_msgs_msg_dds__TFMessage__desc, "rt/tf", DDS_DURABILITY_VOLATILE);
  const dds_entity_t scene =
      read(visualization_msgs_msg_dds__MarkerArray__desc, "rt/scene", DDS_DURABILITY_TRANSIENT_LOCAL);
  if (writers < 0 || tf < 0 || scene < 0) {
    std::cerr << "cannot read" << std::endl;
    return 1;
  }
  const dds_entity_t news = dds_create_waitset(participant);
  for (const dds_entity_t reader : {writers, tf, scene}) {
    dds_set_status_mask(reader, DDS_DATA_AVAILABLE_STATUS);
    dds_waitset_attach(news, reader, reader);
  }
  for (;;) {
    dds_waitset_wait(news, nullptr, 0, DDS_INFINITY);
    Print<dds_builtintopic_endpoint_t>(writers);
    Print<tf2_msgs_msg_dds__TFMessage_>(tf);
    Print<visualization_msgs_msg_dds__MarkerArray_>(scene);
  }
}
