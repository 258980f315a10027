// A law whose library leaves a trace when it is loaded: the file <library>.loaded.
#include <dlfcn.h>

#include <fstream>
#include <string>

#include "agent/laws/plugin/plugin.h"

namespace {

[[gnu::constructor]] void LeaveATrace() {
  Dl_info self{};
  if (dladdr(reinterpret_cast<const void*>(&LeaveATrace), &self) != 0)
    std::ofstream(std::string(self.dli_fname) + ".loaded");
}

class Tracing final : public mascot::Law {
 public:
  explicit Tracing(const mascot::PluginSetup& /*setup*/) {}
  Eigen::Vector3d Want_W(double /*t_s*/, const mascot::Motion& self,
                         std::span<const mascot::Heard> /*heard*/) override {
    return -self.v_WB;
  }
};

}  // namespace

MASCOT_PLUGIN_LAW(Tracing)
