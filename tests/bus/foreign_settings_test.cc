#include "bus/foreign_settings.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <string>
#include <vector>

namespace mascot {
namespace {

TEST(ForeignSettings, AreForgottenAndNothingElseIs) {
  const std::vector<std::string> kept{"ROS_DOMAIN_ID", "FASTD", "MASCOT_RMW_", "ROS_DISCOVERY_SERVERS"};
  std::vector<std::string> forgotten;
  for (const std::string_view setting : ForeignSettings())
    forgotten.push_back(setting.ends_with('*') ? std::string(setting.substr(0, setting.size() - 1)) + "ANYTHING"
                                               : std::string(setting));
  for (const char* name : {"FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE", "FASTDDS_STATISTICS",
                           "FASTDDS_ENVIRONMENT_FILE", "ROS_DISCOVERY_SERVER", "ROS_SUPER_CLIENT", "ROS_LOCALHOST_ONLY",
                           "RMW_IMPLEMENTATION", "RMW_FASTRTPS_USE_QOS_FROM_XML"})
    forgotten.emplace_back(name);
  for (const std::string& name : forgotten) setenv(name.c_str(), "127.0.0.1:11811", 1);
  for (const std::string& name : kept) setenv(name.c_str(), "7", 1);
  setenv("SKIP_DEFAULT_XML_FILE", "0", 1);
  ForgetForeignSettings();
  for (const std::string& name : forgotten) EXPECT_EQ(std::getenv(name.c_str()), nullptr) << name;
  for (const std::string& name : kept) EXPECT_STREQ(std::getenv(name.c_str()), "7") << name;
  EXPECT_STREQ(std::getenv("SKIP_DEFAULT_XML_FILE"), "1");
  for (const std::string& name : kept) unsetenv(name.c_str());
}

}  // namespace
}  // namespace mascot
