// Style "mascot" of laws in Python: control_user(...) of the published testbed.
#include <limits>

#include "agent/laws/custom/custom.h"

namespace mascot {
namespace {

/// Style "mascot": control_user(pos_x, vel_x, acc_x, pos_y, vel_y, acc_y, i, num_agent, leader) of the published
/// testbed, which counts agents from 0. The arrays have an entry for every agent; those of agents that this one does
/// not hear are NaN.
class Published final : public PythonLaw {
 public:
  Published(const CustomParams& params, const CustomLimits& limits, int id, int agents, int leader)
      : PythonLaw(id, params, limits.call, "control_user"),
        agents_(static_cast<std::size_t>(agents)),
        leader_(leader - 1),
        columns_(6, std::vector<double>(agents_)),
        looked_up_(params.looked_up) {
    const PythonLock lock;
    py::module_::import("numpy");
    GuardedImport(limits.import, [&] { control_user_.emplace(PythonModule(params).Function("control_user")); });
  }
  ~Published() override {
    const PythonLock lock;
    control_user_.reset();
  }

  Eigen::Vector3d Want_W(double t_s, const Motion& self, std::span<const Heard> heard) override {
    const PythonLock lock;
    SetTime(t_s);
    for (auto& column : columns_) std::fill(column.begin(), column.end(), std::numeric_limits<double>::quiet_NaN());
    SetColumns(id(), self);
    std::string known;
    for (const Heard& j : heard) {
      SetColumns(j.id, j.motion);
      known += (known.empty() ? "" : ", ") + std::to_string(j.id - 1);
    }
    return Guarded([&] {
      const py::object force =
          (*control_user_)(Array(columns_[0]), Array(columns_[1]), Array(columns_[2]), Array(columns_[3]),
                           Array(columns_[4]), Array(columns_[5]), id() - 1, agents_, leader_);
      if (!std::exchange(is_called_, true)) looked_up_->NoteCall();
      return ToVector(force, "; entries of agents that i = " + std::to_string(id() - 1) +
                                 " does not hear are NaN, and it hears " + (known.empty() ? "nobody" : known) +
                                 " (counted from 0)");
    });
  }

 private:
  void SetColumns(int id, const Motion& motion) {
    const auto i = static_cast<std::size_t>(id - 1);
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      columns_[3 * axis][i] = motion.p_WB[a];
      columns_[3 * axis + 1][i] = motion.v_WB[a];
      columns_[3 * axis + 2][i] = motion.a_WB[a];
    }
  }

  std::size_t agents_;
  int leader_;                                // counted from 0; -1: none
  std::vector<std::vector<double>> columns_;  // pos_x, vel_x, acc_x, pos_y, vel_y, acc_y
  std::shared_ptr<LookedUp> looked_up_;
  bool is_called_ = false;
  std::optional<py::object> control_user_;
};

}  // namespace

std::unique_ptr<Law> MakePublishedLaw(const CustomParams& params, const CustomLimits& limits, int id, int agents,
                                      int leader) {
  return std::make_unique<Published>(params, limits, id, agents, leader);
}

}  // namespace mascot
