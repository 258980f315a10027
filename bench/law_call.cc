// What one call of a law costs an agent that hears five neighbours: consensus in C++, the same in Python, and a law in
// Python that does nothing, which is what Python itself costs. Prints one line of JSON: microseconds per call, the median
// of batches that take turns.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "agent/agent.h"
#include "agent/laws.h"

namespace {

constexpr int kBatches = 41;
constexpr int kCalls = 500;  // per batch

constexpr const char* kNothing = R"(def control(t, me, neighbours):
    return 0.0, 0.0
)";
constexpr const char* kConsensus = R"(def control(t, me, neighbours):
    a = -me.velocity
    for j in neighbours:
        a += j.weight * (j.position - me.position)
    return a
)";

mascot::Experiment Load(const std::string& law) {
  const std::string text =
      "[run]\nduration_s = 1000.0\n[agents]\ncount = 6\nmodel = 'double_integrator'\n[law]\n" + law;
  return mascot::LoadExperiment(mascot::Section::FromText(text, "bench.toml"), "bench");
}

std::string Python(const char* text) { return std::string("name = 'custom'\npython = '''\n") + text + "'''\n"; }

/// Agent 1 of six who all hear each other.
class Caller {
 public:
  explicit Caller(const std::string& law) : experiment_(Load(law)), agent_(experiment_, 1), motions_(6) {
    for (const mascot::AgentConfig& agent : experiment_.agents) {
      motions_[static_cast<std::size_t>(agent.id - 1)].p_WB = agent.p_W;
      if (agent.id > 1) samples_.push_back({&motions_[static_cast<std::size_t>(agent.id - 1)]});
    }
  }
  void Batch() {
    const auto start = std::chrono::steady_clock::now();
    for (int k = 0; k < kCalls; ++k) agent_.Want(tick_++, motions_[0], samples_);
    const std::chrono::duration<double, std::micro> wall = std::chrono::steady_clock::now() - start;
    us_.push_back(wall.count() / kCalls);
  }
  double median_us() {
    std::nth_element(us_.begin(), us_.begin() + kBatches / 2, us_.end());
    return us_[kBatches / 2];
  }

 private:
  mascot::Experiment experiment_;
  mascot::Agent agent_;
  std::vector<mascot::Motion> motions_;
  std::vector<mascot::Sample> samples_;
  std::int64_t tick_ = 0;
  std::vector<double> us_;
};

}  // namespace

int main() {
  Caller cpp("name = 'consensus'\n"), nothing(Python(kNothing)), consensus(Python(kConsensus));
  for (int batch = 0; batch < kBatches; ++batch)
    for (Caller* caller : {&cpp, &nothing, &consensus}) caller->Batch();
  std::printf("{\"cpp_consensus_us\": %.3f, \"python_nothing_us\": %.2f, \"python_consensus_us\": %.2f}\n",
              cpp.median_us(), nothing.median_us(), consensus.median_us());
}
