// Preloaded into programs: leaving a DDS domain never ends, in processes whose name is $MASCOT_HANGS. It also prints
// that it has begun.

#include <errno.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>

namespace eprosima::fastdds::dds {

// Takes the place of Fast DDS's own function.
eprosima::fastrtps::types::ReturnCode_t DomainParticipantFactory::delete_participant(DomainParticipant*) {
  const char* hangs = std::getenv("MASCOT_HANGS");
  if (hangs == nullptr || std::strcmp(hangs, program_invocation_short_name) != 0)
    return eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK;
  std::fputs("leaving the domain hangs\n", stderr);
  for (;;) pause();
}

}  // namespace eprosima::fastdds::dds
