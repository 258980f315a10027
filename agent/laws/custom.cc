// A law written by the user in Python: control(t, me, neighbours) -> acceleration or velocity in W.
#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "agent/laws.h"
#include "agent/python_internal.h"
#include "experiment/experiment.h"
#include "experiment/toml/utf8.h"

namespace mascot {
namespace {

/// Which functions a custom law defines.
enum class PythonStyle {
  kStandard,  ///< control(t, me, neighbours), start, message
  kMascot,    ///< control_user(...) of the published testbed
};

constexpr EnumNames<PythonStyle, 2> kPythonStyles({{PythonStyle::kStandard, "standard"},
                                                   {PythonStyle::kMascot, "mascot"}});
constexpr EnumNames<Wanted, 2> kPythonOutputs({{Wanted::kAcceleration, "acceleration"},
                                               {Wanted::kVelocity, "velocity"}});

constexpr Key kCustomParameters[] = {
    key::Text("python",
              "the law itself: defines control(t, me, neighbours), may define start(me, params), message(me), set(me, "
              "params)"),
    key::Text("file", "a file that holds the law, instead of python; its path from the folder of this file"),
    key::Any("params", "goes to start(me, params) as a dict, and to set(me, params) when an event has changed it")
        .Default("{}")
        .Live(),
    key::OneOf("style", kPythonStyles.names(),
               "mascot: the published testbed's control_user(pos_x, vel_x, acc_x, pos_y, vel_y, acc_y, i, num_agent, "
               "leader)")
        .Default("\"standard\""),
    key::OneOf("output", kPythonOutputs.names(), "what control returns, 3 numbers or 2 (x, y), in W")
        .Default("\"acceleration\""),
    key::Boolean("messages", "whether it sends messages").Otherwise("whether it defines message"),
    key::Integer("leader", 0, kMaxAgents,
                 "for control_user, which counts agents from 0: given as leader - 1, -1 if there is none")
        .Default("0"),
    key::Text("python_file", "what python goes by in messages").Otherwise("this file"),
    key::Integer("python_line", 1, 1'000'000, "the line of python_file at which python begins")
        .Otherwise("where it stands"),
};

// Part of run.agent_timeout_s that a call of the law may take: less than all, so that the law is interrupted first and
// the message says where it hangs.
constexpr double kTimeShare = 0.8;

// The class of `me` and of each of `neighbours`. `me` lives as long as the law, so that the law can keep what it wants
// to remember in it; the neighbours are new objects at each call.
constexpr const char* kClasses = R"(
class Agent:
    """One agent, as this one knows it. Positions and velocities are in the world frame (x east, y north, z up)."""

    def __repr__(self):
        return f"agent {self.id} at {self.position}"
)";

/// A law written in Python, and where its text stands.
struct CustomParams final : LawParams {
  std::string text;
  std::string file;  ///< the file's name in messages
  int line = 1;      ///< line of `file` at which `text` begins
  PythonStyle style = PythonStyle::kStandard;
  Wanted wanted = Wanted::kAcceleration;
  Value params;  ///< a table
};

/// A new NumPy array that holds `values`.
py::array_t<double> Array(std::span<const double> values) {
  py::array_t<double> array(static_cast<py::ssize_t>(values.size()));  // filled below: half the time of a copy
  std::ranges::copy(values, array.mutable_data());
  return array;
}
py::array_t<double> Array(const Eigen::Vector3d& v) { return Array(std::span<const double>(v.data(), 3)); }

/// Attribute names as Python strings, made once.
struct Names {
  py::str id{"id"}, position{"position"}, velocity{"velocity"}, acceleration{"acceleration"},
      orientation{"orientation"}, angular_velocity{"angular_velocity"}, weight{"weight"}, message{"message"},
      age_s{"age_s"};
};

/// repr() of a returned value, for a message; its type if repr() fails.
std::string Repr(const py::handle& value) try {
  constexpr std::size_t kLongest = 200;
  const std::string text = TextOf(py::repr(value));
  return text.size() <= kLongest ? text : std::string(CutUtf8(text, kLongest)) + "...";
} catch (py::error_already_set&) {
  return "an object of type " + TextOf(py::type::of(value).attr("__name__"));
}

/// The numbers in a returned value; nullopt if it is not a flat sequence of numbers.
std::optional<std::vector<double>> Numbers(const py::object& value) {
  std::vector<double> numbers;
  if (PyTuple_Check(value.ptr()) || PyList_Check(value.ptr())) {  // the usual case, and the fastest
    for (const py::handle& item : py::reinterpret_borrow<py::sequence>(value)) {
      const double number = PyFloat_AsDouble(item.ptr());
      if (number == -1 && PyErr_Occurred() != nullptr) {
        PyErr_Clear();
        return std::nullopt;
      }
      numbers.push_back(number);
    }
    return numbers;
  }
  constexpr std::string_view kReal = "biufO";  // NumPy would also make numbers of text, dates and complex numbers
  if (!py::isinstance<py::array>(value) ||
      kReal.find(value.attr("dtype").attr("kind").cast<std::string>()) == std::string_view::npos)
    return std::nullopt;
  const auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(value);
  if (!array) {
    PyErr_Clear();
    return std::nullopt;
  }
  if (array.ndim() != 1) return std::nullopt;
  numbers.assign(array.data(), array.data() + array.size());
  return numbers;
}

/// The user's text, run in a Python namespace of its own for one agent.
class Module {
 public:
  explicit Module(const CustomParams& params) : space_(RunPython(params.text, params.file, params.line)) {}

  /// The function `name` that the text defines; None if it defines none.
  py::object Function(const char* name) const {
    const py::object function = space_.contains(name) ? py::object(space_[name]) : py::none();
    return PyCallable_Check(function.ptr()) != 0 ? function : py::none();
  }

 private:
  py::dict space_;
};

/// The base of both styles: the time limit, and errors that name the agent, the time and the returned value.
class PythonLaw : public Law {
 public:
  PythonLaw(int id, const CustomParams& params, TimeLimit time_limit, const char* function)
      : id_(id), time_limit_(time_limit), wanted_(params.wanted), file_(params.file), function_(function) {}
  Wanted wanted() const override { return wanted_; }

 protected:
  int id() const { return id_; }

  /// Runs `call`, which calls the user's code, with the time limit. Throws std::runtime_error with the traceback.
  template <class Call>
  auto Guarded(Call call) const {
    try {
      const PythonTimeLimit limit(time_limit_);
      return call();
    } catch (py::error_already_set& error) {
      throw std::runtime_error("the law of agent " + std::to_string(id_) + " failed at t = " + ShortestFloat(t_s_) +
                               " s\n" + Explain(error, file_).what());
    }
  }
  void SetTime(double t_s) { t_s_ = t_s; }

  /// `value` as a vector, from two (z = 0) or three finite numbers. `hint`: what a NaN may come from, for the message.
  Eigen::Vector3d ToVector(const py::object& value, const std::string& hint) const {
    const auto numbers = Numbers(value);
    if (!numbers || numbers->size() < 2 || numbers->size() > 3)
      Refuse(value,
             value.is_none() ? ", expected 3 numbers or 2 (has it no return?)" : ", expected 3 numbers or 2 (x, y)");
    const Eigen::Vector3d vector((*numbers)[0], (*numbers)[1], numbers->size() == 3 ? (*numbers)[2] : 0);
    if (!vector.allFinite()) Refuse(value, ", expected finite numbers" + (vector.hasNaN() ? hint : ""));
    return vector;
  }

  [[noreturn]] void Refuse(const py::object& value, const std::string& why) const {
    throw std::runtime_error("the law of agent " + std::to_string(id_) + " failed at t = " + ShortestFloat(t_s_) +
                             " s: " + function_ + " returned " + Repr(value) + why);
  }

 private:
  int id_;
  TimeLimit time_limit_;
  Wanted wanted_;
  std::string file_;
  std::string function_;
  double t_s_ = 0;
};

/// Style "standard": control(t, me, neighbours), start(me, params), message(me).
class Standard final : public PythonLaw {
 public:
  Standard(const CustomParams& params, TimeLimit time_limit, std::uint64_t seed, int id)
      : PythonLaw(id, params, time_limit, "control"), params_(ToToml(params.params)) {
    const PythonLock lock;
    objects_.emplace(params);
    Objects& o = *objects_;
    if (!o.start.is_none() || !o.set.is_none()) o.params = ToPython(params.params);
    o.me = o.agent_class();
    o.me.attr("id") = id;
    o.me.attr("weight") = 0.0;
    o.me.attr("age_s") = 0.0;
    o.me.attr("message") = py::none();
    o.me.attr("random") = py::module_::import("numpy").attr("random").attr("default_rng")(py::make_tuple(seed, id));
  }
  ~Standard() override {
    const PythonLock lock;
    objects_.reset();
  }

  Eigen::Vector3d Want_W(double t_s, const Motion& self, std::span<const Heard> heard) override {
    const PythonLock lock;
    Objects& o = *objects_;
    SetTime(t_s);
    SetMotion(o.me, self);
    return Guarded([&] {
      if (!o.start.is_none()) {
        o.start(o.me, o.params);
        o.start = py::none();
      }
      if (o.params_changed && !o.set.is_none()) o.set(o.me, o.params);
      o.params_changed = false;
      py::list neighbours(heard.size());
      for (std::size_t k = 0; k < heard.size(); ++k) neighbours[k] = Neighbour(heard[k]);
      return ToVector(o.control(t_s, o.me, neighbours), "");
    });
  }

  void Adopt(const AgentConfig& agent) override {
    const PythonLock lock;
    const Value& params = ParamsOf<CustomParams>(agent.law).params;
    if (ToToml(params) == params_) return;
    params_ = ToToml(params);
    objects_->params = ToPython(params);
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
      py::module_::import("numpy");  // now, so that the first tick does not wait for it
    }
    Module module;
    py::object control = module.Function("control"), start = module.Function("start"),
               message = module.Function("message"), set = module.Function("set"), agent_class, me, params = py::dict();
    bool params_changed = false;  // by an event: set() is called before the next control()
    Names names;
  };

  void SetMotion(const py::object& agent, const Motion& motion) const {
    const Names& names = objects_->names;
    const double wxyz[] = {motion.q_WB.w(), motion.q_WB.x(), motion.q_WB.y(), motion.q_WB.z()};
    py::setattr(agent, names.position, Array(motion.p_WB));
    py::setattr(agent, names.velocity, Array(motion.v_WB));
    py::setattr(agent, names.acceleration, Array(motion.a_WB));
    py::setattr(agent, names.orientation, Array(wxyz));
    py::setattr(agent, names.angular_velocity, Array(motion.w_WB_B));
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
  std::string params_;              // as TOML
  std::vector<double> message_;
};

/// Style "mascot": control_user(pos_x, vel_x, acc_x, pos_y, vel_y, acc_y, i, num_agent, leader) of the published
/// testbed, which counts agents from 0. The arrays have an entry for every agent; those of agents that this one does
/// not hear are NaN.
class Published final : public PythonLaw {
 public:
  Published(const CustomParams& params, TimeLimit time_limit, int id, int agents, int leader)
      : PythonLaw(id, params, time_limit, "control_user"),
        agents_(static_cast<std::size_t>(agents)),
        leader_(leader - 1),
        columns_(6, std::vector<double>(agents_)) {
    const PythonLock lock;
    control_user_.emplace(Module(params).Function("control_user"));
    py::module_::import("numpy");
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
  std::optional<py::object> control_user_;
};

/// A function that the text may define.
struct Callback {
  const char* name;
  const char* arguments;
  std::size_t count;
  bool required;
};

constexpr Callback kStandardCallbacks[] = {{"control", "(t, me, neighbours)", 3, true},
                                           {"start", "(me, params)", 2, false},
                                           {"set", "(me, params)", 2, false},
                                           {"message", "(me)", 1, false}};
constexpr Callback kPublishedCallbacks[] = {
    {"control_user", "(pos_x, vel_x, acc_x, pos_y, vel_y, acc_y, i, num_agent, leader)", 9, true}};

std::span<const Callback> CallbacksOf(PythonStyle style) {
  if (style == PythonStyle::kMascot) return kPublishedCallbacks;
  return kStandardCallbacks;
}

const char* TextKey(const Section& law) { return law.Has("file") ? "file" : "python"; }

/// Reads the text of the law, and the file and line for messages.
void ReadText(Section& law, CustomParams& params) {
  law.Supersede("file", {"python", "python_file", "python_line"});
  law.Supersede("python", {"file", "python_file", "python_line"});
  if (law.Has("python") == law.Has("file")) {
    law.Fail(law.Has("file") ? "file" : "",
             std::string("expected one of python, file, got ") + (law.Has("file") ? "both" : "none"));
    return;
  }
  Section::FileText text;
  int line = 1;
  if (law.Has("file")) {
    text = law.TextOfFile("file", "python");
  } else {
    const Section::Place place = law.PlaceOfText("python");
    text = {law.Text("python"), place.file};
    line = place.line;
  }
  params.text = text.text;
  params.file = law.Text("python_file", text.name);
  params.line = static_cast<int>(law.Integer("python_line", 1, 1'000'000, line));
  if (params.text.find('\0') != std::string::npos) law.Fail(TextKey(law), "expected text, got a NUL byte");
}

void ReadKeys(Section& law, CustomParams& params) {
  ReadText(law, params);
  params.style = kPythonStyles.Value(law.OneOf("style"));
  params.wanted = kPythonOutputs.Value(law.OneOf("output"));
  if (law.Has("params") && law.Kind("params") != "table")
    law.Fail("params", "expected a table, got a " + law.Kind("params"));
  else
    params.params = law.Free("params");
}

/// Notes a mistake if the function is required and missing, or cannot be called with its arguments.
void CheckCallback(Section& law, const CustomParams& params, const Module& module, const Callback& callback) {
  const py::object function = module.Function(callback.name);
  const auto fail = [&](int line, const std::string& message) {
    law.FailInText(TextKey(law), params.file + ":" + std::to_string(line) + ":1", message);
  };
  if (function.is_none()) {
    if (callback.required) fail(params.line, std::string("expected a function ") + callback.name + ", got none");
    return;
  }
  const std::string other = SignatureIfNotCallable(function, callback.count);
  if (!other.empty())
    fail(std::max(LineOf(function), 1),
         std::string("expected ") + callback.name + callback.arguments + ", got " + callback.name + other);
}

/// Runs the text once, to find mistakes in it and the functions that it defines. Returns whether it can send messages.
bool Try(Section& law, CustomParams& params, const TimeLimit& time_limit) {
  const SuppressedPythonOutput suppressed;
  const PythonLock lock;
  const char* key = TextKey(law);
  try {
    const PythonTimeLimit limit(time_limit);
    const Module module(params);
    for (const Callback& callback : CallbacksOf(params.style)) CheckCallback(law, params, module, callback);
    if (module.Function("set").is_none()) params.fixed = "expected a law that defines set(me, params), got none";
    return params.style == PythonStyle::kStandard && !module.Function("message").is_none();
  } catch (const PythonError& error) {
    law.FailInText(key,
                   params.file + ":" + std::to_string(std::max(error.line(), 1)) + ":" +
                       std::to_string(std::max(error.column(), 1)),
                   "expected Python, got " + error.summary());
    return false;
  }
}

/// Whether the law sends messages: as the key says, else whether the text defines message().
bool SendsMessages(const Experiment& experiment, CustomParams& params, Section& law) {
  // A checked experiment has the key: reading it need not start Python.
  if ((experiment.checked && law.Has("messages")) || law.Wrong("")) return law.Boolean("messages", false);
  const bool can_send = Try(law, params, {experiment.run.start_timeout_s, "run.start_timeout_s"});
  const bool sends = law.Boolean("messages", can_send);
  if (sends && !can_send && !law.Wrong("")) law.Fail("messages", "expected a law that defines message(me), got none");
  return sends;
}

std::shared_ptr<const LawParams> ReadCustom(const Experiment& experiment, const LawConfig& /*law*/, Section& section) {
  auto params = std::make_shared<CustomParams>();
  ReadKeys(section, *params);
  params->sends_messages = SendsMessages(experiment, *params, section);
  return params;
}

std::unique_ptr<Law> MakeCustom(const Experiment& experiment, int id) {
  const LawConfig& law = experiment.agent(id).law;
  const auto& params = ParamsOf<CustomParams>(law);
  const TimeLimit time_limit{kTimeShare * experiment.run.agent_timeout_s, "0.8 run.agent_timeout_s"};
  if (params.style == PythonStyle::kMascot)
    return std::make_unique<Published>(params, time_limit, id, experiment.size(), law.leader);
  return std::make_unique<Standard>(params, time_limit, experiment.run.seed, id);
}

Wanted WantedByCustom(const LawConfig& law) { return ParamsOf<CustomParams>(law).wanted; }

}  // namespace

LawEntry CustomLaw() {
  return {.name = "custom",
          .summary =
              "your own law, in Python: what one agent wants, from what it knows of itself and heard of its neighbours",
          .equation = "control(t, me, neighbours) -> [a_x, a_y, a_z] or [a_x, a_y]",
          .theory = "none: check knows only built-in laws",
          .source = "docs/laws.md",
          .parameters = kCustomParameters,
          .drawing = {.pictures = kDisagreementPicture},
          .read = ReadCustom,
          .make = MakeCustom,
          .wanted = WantedByCustom};
}

}  // namespace mascot
