#include "orchestrator/engines/dds/host_words.h"

#include <sys/stat.h>

#include <fstream>

namespace mascot {

std::string MachineText() {
  std::string boot;
  std::getline(std::ifstream("/proc/sys/kernel/random/boot_id"), boot);
  struct stat memory {};
  stat("/dev/shm", &memory);
  return boot + " " + std::to_string(memory.st_dev);
}

}  // namespace mascot
