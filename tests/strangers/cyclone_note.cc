// cyclone_note DOMAIN TOPIC: writes notes on a DDS topic by Eclipse Cyclone DDS, over 127.0.0.1, until it is killed.
#include <dds/dds.h>

#include <chrono>
#include <cstdlib>
#include <iostream>
#include <thread>

#include "note.h"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  setenv("CYCLONEDDS_URI", "<General><Interfaces><NetworkInterface name='lo' multicast='true'/></Interfaces></General>",
         1);
  const dds_entity_t participant =
      dds_create_participant(static_cast<dds_domainid_t>(std::atoi(argv[1])), nullptr, nullptr);
  const dds_entity_t topic = dds_create_topic(participant, &Note_desc, argv[2], nullptr, nullptr);
  const dds_entity_t writer = dds_create_writer(participant, topic, nullptr, nullptr);
  if (writer < 0) {
    std::cerr << "cannot write: " << dds_strretcode(writer) << std::endl;
    return 1;
  }
  char text[] = "who am I?";
  const Note note{text};
  for (;;) {
    dds_write(writer, &note);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}
