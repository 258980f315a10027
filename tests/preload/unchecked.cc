// Preloaded into programs: Fast DDS makes every reader and writer that is asked for, whatever the permissions say. Only
// its own process is fooled.

#include <string>
#include <vector>

namespace eprosima::fastrtps::rtps::security {

class Handle;
class SecurityException;

// Fast DDS installs no header of this class: these functions take the place of its own.
class Permissions {
 public:
  using Partitions = std::vector<std::string>;
  bool check_create_datareader(const Handle& permissions, unsigned domain, const std::string& topic,
                               const Partitions& partitions, SecurityException& why);
  bool check_create_datawriter(const Handle& permissions, unsigned domain, const std::string& topic,
                               const Partitions& partitions, SecurityException& why);
};

bool Permissions::check_create_datareader(const Handle&, unsigned, const std::string&, const Partitions&,
                                          SecurityException&) {
  return true;
}

bool Permissions::check_create_datawriter(const Handle&, unsigned, const std::string&, const Partitions&,
                                          SecurityException&) {
  return true;
}

}  // namespace eprosima::fastrtps::rtps::security
