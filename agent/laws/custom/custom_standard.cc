// Style "standard" of laws in Python: control(t, me, neighbours), start(me, params), set(me, params), message(me).
#include "agent/laws/custom/custom.h"

namespace mascot {
namespace {

// The class of `me` and of each of `neighbours`. `me` lives as long as the law, so that the law can keep what it wants
// to remember in it; the neighbours are new objects at each call.
constexpr const char* kClasses = R"(
class Agent:
    """One agent, as this one knows it. Positions and velocities are in the world frame (x east, y north, z up)."""

    def __repr__(self):
        return f"agent {self.id} at {self.position}"
)";

py::array_t<double> Array3(const Eigen::Vector3d& v) { return Array(std::span<const double>(v.data(), 3)); }

/// Attribute names as Python strings, made once.
struct Names {
  py::str id{"id"}, position{"position"}, velocity{"velocity"}, acceleration{"acceleration"},
      orientation{"orientation"}, angular_velocity{"angular_velocity"}, weight{"weight"}, message{"message"},
      age_s{"age_s"}, ranges{"ranges"};
};

class Standard final : public PythonLaw {
 public:
  Standard(const CustomParams& params, const CustomLimits& limits, std::uint64_t seed, int id)
      : PythonLaw(id, params, limits.call, "control"), params_(ToToml(params.params)), looked_up_(params.looked_up) {
    const PythonLock lock;
    py::module_::import("numpy");  // now, so that the first tick does not wait for it
    GuardedImport(limits.import, [&] { objects_.emplace(params); });
    Objects& o = *objects_;
    if (!o.start.is_none() || !o.set.is_none()) o.TakeParams(params);
    o.me = o.agent_class();
    o.me.attr("id") = id;
    o.me.attr("weight") = 0.0;
    o.me.attr("age_s") = 0.0;
    o.me.attr("message") = py::none();
    o.me.attr("rng") = py::module_::import("numpy").attr("random").attr("default_rng")(py::make_tuple(seed, id));
    o.me.attr("random") = o.me.attr("rng");
  }
  ~Standard() override {
    const PythonLock lock;
    objects_.reset();
  }

  void See(std::span<const Eigen::Vector3d> nearest_W) override { seen_W_ = nearest_W; }

  Eigen::Vector3d Want_W(double t_s, const Motion& self, std::span<const Heard> heard) override {
    const PythonLock lock;
    Objects& o = *objects_;
    SetTime(t_s);
    SetMotion(o.me, self);
    py::setattr(o.me, o.names.ranges, Rows(seen_W_));
    return Guarded([&] {
      if (!o.start.is_none()) {
        o.start(o.me, o.params);
        o.start = py::none();
      }
      if (o.params_changed && !o.set.is_none()) o.set(o.me, o.params);
      o.params_changed = false;
      py::list neighbours(heard.size());
      for (std::size_t k = 0; k < heard.size(); ++k) neighbours[k] = Neighbour(heard[k]);
      const Eigen::Vector3d wanted = ToVector(o.control(t_s, o.me, neighbours), "");
      if (!std::exchange(is_called_, true)) looked_up_->NoteCall();
      return wanted;
    });
  }

  void Adopt(const AgentConfig& agent) override {
    const PythonLock lock;
    const auto& law = ParamsOf<CustomParams>(agent.law);
    if (ToToml(law.params) == params_) return;
    params_ = ToToml(law.params);
    objects_->TakeParams(law);
    objects_->params_changed = true;
  }

  std::span<const double> Message() override {
    const PythonLock lock;
    Objects& o = *objects_;
    const py::object result = Guarded([&]() -> py::object { return o.message(o.me); });
    message_.clear();
    o.me.attr("message") = py::none();
    if (result.is_none()) return message_;
    auto numbers = Numbers(result);
    if (!numbers || numbers->size() > kMaxMessage)
      throw std::runtime_error("the law of agent " + std::to_string(id()) + " failed: message returned " +
                               Repr(result) + ", expected None or at most " + std::to_string(kMaxMessage) + " numbers");
    message_ = std::move(*numbers);
    o.me.attr("message") = Array(message_);
    return message_;
  }

 private:
  struct Objects {
    explicit Objects(const CustomParams& law) : module(law) {
      py::dict space;
      py::exec(kClasses, space);
      agent_class = space["Agent"];
    }
    /// The law's params become the defaults of PARAMETERS, with those that are given in their places.
    void TakeParams(const CustomParams& law) {
      const py::object defaults = module.Parameters();
      if (defaults.is_none()) {
        params = LookedUp::Watched(ToPython(law.params), law.looked_up);
        return;
      }
      params = py::module_::import("copy").attr("deepcopy")(defaults);
      params.attr("update")(ToPython(law.params));
      law.looked_up->TakeAll();
    }
    PythonModule module;
    py::object control = module.Function("control"), start = module.Function("start"),
               message = module.Function("message"), set = module.Function("set"), agent_class, me, params = py::dict();
    bool params_changed = false;  // by an event: set() is called before the next control()
    Names names;
  };

  void SetMotion(const py::object& agent, const Motion& motion) const {
    const Names& names = objects_->names;
    const double wxyz[] = {motion.q_WB.w(), motion.q_WB.x(), motion.q_WB.y(), motion.q_WB.z()};
    py::setattr(agent, names.position, Array3(motion.p_WB));
    py::setattr(agent, names.velocity, Array3(motion.v_WB));
    py::setattr(agent, names.acceleration, Array3(motion.a_WB));
    py::setattr(agent, names.orientation, Array(wxyz));
    py::setattr(agent, names.angular_velocity, Array3(motion.w_WB_B));
  }

  py::object Neighbour(const Heard& heard) const {
    const Names& names = objects_->names;
    py::object neighbour = objects_->agent_class();
    SetMotion(neighbour, heard.motion);
    py::setattr(neighbour, names.id, py::int_(heard.id));
    py::setattr(neighbour, names.weight, py::float_(heard.weight));
    py::setattr(neighbour, names.age_s, py::float_(heard.age_s));
    py::setattr(neighbour, names.message,
                heard.message.empty() ? py::object(py::none()) : py::object(Array(heard.message)));
    return neighbour;
  }

  std::optional<Objects> objects_;  // made and destroyed with the GIL held
  std::span<const Eigen::Vector3d> seen_W_;
  std::string params_;  // as TOML
  std::shared_ptr<LookedUp> looked_up_;
  bool is_called_ = false;
  std::vector<double> message_;
};

}  // namespace

std::unique_ptr<Law> MakeStandardLaw(const CustomParams& params, const CustomLimits& limits, std::uint64_t seed,
                                     int id) {
  return std::make_unique<Standard>(params, limits, seed, id);
}

}  // namespace mascot
