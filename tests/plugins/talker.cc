// A law that sends messages: agents move at random and pass on what they have heard.
#include <random>
#include <vector>

#include "agent/laws/plugin/plugin.h"

namespace {

class Talker final : public mascot::Law {
 public:
  explicit Talker(const mascot::PluginSetup& setup)
      : random_(1000 * setup.seed + static_cast<std::uint64_t>(setup.id)),
        words_(static_cast<std::size_t>(setup.params.Integer("words", 0, 100, 2))) {}

  Eigen::Vector3d Want_W(double /*t_s*/, const mascot::Motion& self, std::span<const mascot::Heard> heard) override {
    for (const mascot::Heard& j : heard)
      for (const double word : j.message) heard_sum_ += 0.01 * word;
    const double unit = static_cast<double>(random_() >> 11) * 0x1.0p-53;
    return Eigen::Vector3d(unit, heard_sum_, 0) - self.v_WB;
  }

  std::span<const double> Message() override {
    words_.assign(words_.size(), 1 + heard_sum_);
    return words_;
  }

 private:
  std::mt19937_64 random_;
  std::vector<double> words_;
  double heard_sum_ = 0;
};

}  // namespace

MASCOT_PLUGIN_LAW(Talker)
