// The module mascot._mascot: what mascot/*.py stands on. Arrays go in and out as NumPy's; while C++ computes, other
// threads of Python run.
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "agent/laws/laws.h"
#include "agent/network/network.h"
#include "base/same_floating_point.h"
#include "base/state_numbers.h"
#include "experiment/toml/input.h"
#include "orchestrator/engines/inprocess.h"
#include "orchestrator/live/server/address.h"
#include "orchestrator/recording/recording.h"
#include "orchestrator/recording/row_codec.h"
#include "orchestrator/recording/run_arrays.h"
#include "orchestrator/recording/run_folder.h"
#include "python/team_env.h"
#include "python/team_vector.h"

namespace mascot {
namespace {

namespace py = pybind11;

using Sets = std::vector<std::pair<std::string, std::string>>;  // keys and their values as TOML
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Bools = py::array_t<bool, py::array::c_style | py::array::forcecast>;

std::vector<Override> OverridesOf(const Sets& sets) {
  std::vector<Override> overrides;
  for (const auto& [key, value] : sets)
    overrides.push_back({.key = key, .value = value, .origin = "set " + key + " = " + value});
  return overrides;
}

std::optional<std::vector<Override>> OverridesOf(const std::optional<Sets>& sets) {
  return sets ? std::optional(OverridesOf(*sets)) : std::nullopt;
}

/// How often this process was forked off from others, since the module was loaded.
std::atomic<int> forks = 0;

/// An environment that one thread at a time may use, of the process that has made it: its threads are not in a fork.
template <class Environment>
struct OneAtATime : Environment {
  using Environment::Environment;
  std::atomic<bool> is_used = false;
  const int made_in = forks;
};

/// A fork leaves the environments of its parent as they are.
struct Delete {
  template <class Environment>
  void operator()(OneAtATime<Environment>* environment) const {
    if (environment->made_in == forks) delete environment;
  }
};

/// A thread uses an environment.
class Use {
 public:
  template <class Environment>
  explicit Use(OneAtATime<Environment>& environment) : is_used_(environment.is_used) {
    if (environment.made_in != forks)
      throw std::runtime_error("expected an environment that this process has made, got one of its parent");
    if (is_used_.exchange(true)) throw std::runtime_error("expected one thread at a time in an environment, got two");
  }
  ~Use() { is_used_ = false; }
  Use(const Use&) = delete;
  Use& operator=(const Use&) = delete;

 private:
  std::atomic<bool>& is_used_;
};

/// A method for Python: calls method(environment, arguments...), if no other thread is in a method of the environment.
template <class Environment, class Method, class Result, class First, class... Arguments>
auto AloneAs(Method method, Result (Method::* /*signature*/)(First, Arguments...) const) {
  return [method](OneAtATime<Environment>& environment, Arguments... arguments) -> Result {
    const Use use(environment);
    return method(environment, std::forward<Arguments>(arguments)...);
  };
}
template <class Environment, class Method>
auto Alone(Method method) {
  return AloneAs<Environment>(method, &Method::operator());
}
template <class Environment, class Result, class First, class... Arguments>
auto Alone(Result (*method)(First, Arguments...)) {
  return Alone<Environment>(
      [method](First first, Arguments... arguments) -> Result { return method(first, arguments...); });
}

/// What a folder is called that is given as `argument` of a function in Python.
RunFolder::Words WordsFor(const std::string& argument) { return {.out = argument, .force = "force=True"}; }

/// When the interpreter ends, it ends each thread that asks for its lock, by unwinding the thread's stack, which C++
/// does not survive. So a thread of ours that needs the lock then waits for the end of the process instead.
std::atomic<unsigned long> ended_by = 0;  // the thread that ends the interpreter; 0: none does yet
std::atomic<int> taking = 0;              // threads that are taking the lock: the interpreter waits for them

/// Calls take(), which takes the lock of the interpreter.
template <class Take>
void TakeInterpreter(Take&& take) {
  ++taking;
  if (ended_by != 0 && ended_by != PyThread_get_thread_ident()) {
    --taking;
    for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
  }
  take();
  --taking;
}

/// In the child process, which has the thread that forked, and no other.
void OnFork() {
  ++forks;
  taking = 0;
}

void OnEndOfInterpreter() {
  ended_by = PyThread_get_thread_ident();
  const py::gil_scoped_release release;
  while (taking > 0) std::this_thread::yield();
}

/// Without the lock of the interpreter.
class Released {
 public:
  Released() : state_(PyEval_SaveThread()) {}
  ~Released() {
    TakeInterpreter([this] { PyEval_RestoreThread(state_); });
  }
  Released(const Released&) = delete;
  Released& operator=(const Released&) = delete;

 private:
  PyThreadState* const state_;
};

/// Calls work() without the lock of the interpreter, and with the arithmetic of our programs.
template <class Work>
auto Compute(Work&& work) {
  const Released released;
  const SameFloatingPoint same;
  return work();
}

/// Whether Python has a signal to handle, such as Ctrl-C: looks a few times a second.
class Signals {
 public:
  bool AreThere() {
    const auto now = std::chrono::steady_clock::now();
    if (now < next_) return false;
    next_ = now + std::chrono::milliseconds(50);
    std::optional<py::gil_scoped_acquire> acquired;
    TakeInterpreter([&] { acquired.emplace(); });
    return PyErr_CheckSignals() != 0;  // then it has set what the handler has raised
  }

 private:
  std::chrono::steady_clock::time_point next_ = {};
};

/// A handler of a signal has raised in this thread since ComputeOrWait() has begun.
thread_local bool has_raised = false;

bool MayGoOn() {
  thread_local Signals signals;
  return !(has_raised = has_raised || signals.AreThere());
}

/// As Compute(), for what takes long, or waits for viewers, and asks MayGoOn(): Python hears what a handler has raised.
template <class Work>
void ComputeOrWait(Work&& work) {
  has_raised = false;
  Compute(work);
  if (has_raised) throw py::error_already_set();
}

py::array_t<double> ArrayOf(std::span<const double> values, std::vector<py::ssize_t> shape) {
  py::array_t<double> array(std::move(shape));
  std::ranges::copy(values, array.mutable_data());
  return array;
}

std::vector<char> CharsOf(const Bools& bools) { return {bools.data(), bools.data() + bools.size()}; }

py::ssize_t Count(std::size_t count) { return static_cast<py::ssize_t>(count); }

/// Requires `count` numbers; whoever calls this from Python has checked the shape.
std::span<const double> Numbers(const Doubles& array, std::size_t count) {
  if (static_cast<std::size_t>(array.size()) != count)
    throw py::value_error("expected " + std::to_string(count) + " numbers, got " + std::to_string(array.size()));
  return {array.data(), count};
}

// --- what does not change -----------------------------------------------------------------------------

py::dict AboutTeam(const TeamEnv& team) {
  const Experiment& experiment = team.experiment();
  py::dict about;
  about["name"] = experiment.run.name;
  about["agents"] = experiment.size();
  about["ids"] = team.agents();
  about["seed"] = experiment.run.seed;
  about["rate_hz"] = experiment.control.rate_hz;
  about["ticks"] = experiment.ticks();
  about["duration_s"] = experiment.run.duration_s;
  about["action_size"] = team.action_size();
  py::list action_high;
  for (std::size_t k = 0; k < team.agents().size(); ++k)
    action_high.append(ArrayOf(team.action_high(k), {Count(team.action_size(k))}));
  about["action_high"] = action_high;
  about["observation_high"] = ArrayOf(team.observation_high(), {Count(team.layout().size())});
  about["observation_text"] = team.layout().Text();
  about["observation_hash"] = team.layout().Hash();
  about["observation_names"] = team.layout().Names();
  about["places"] = team.layout().places;
  about["message"] = team.layout().message;
  return about;
}

// --- one environment ------------------------------------------------------------------------------------

py::array_t<double> ObservationsOf(const TeamEnv& team) {
  return ArrayOf(team.observations(), {Count(team.agents().size()), Count(team.layout().size())});
}

py::array_t<double> StateOf(const TeamEnv& team) {
  py::array_t<double> state({py::ssize_t{team.experiment().size()}, Count(kStateNumbers)});
  team.StateTo({state.mutable_data(), static_cast<std::size_t>(state.size())});
  return state;
}

py::array_t<bool> LostOf(const TeamEnv& team) {
  py::array_t<bool> lost(Count(team.agents().size()));
  for (std::size_t k = 0; k < team.agents().size(); ++k) lost.mutable_data()[k] = team.is_lost(k);
  return lost;
}

py::array_t<double> Vector(const Eigen::Vector3d& v) { return ArrayOf({v.data(), 3}, {3}); }

/// What a law knows of an agent: id, position, velocity, acceleration, orientation (w, x, y, z), angular velocity,
/// weight, message or None, age_s.
py::tuple Known(int id, const Motion& motion, double weight, std::optional<std::span<const double>> message,
                double age_s) {
  const auto& q = motion.q_WB;
  const std::array orientation{q.w(), q.x(), q.y(), q.z()};
  py::object said = py::none();
  if (message && !message->empty()) said = ArrayOf(*message, {Count(message->size())});
  return py::make_tuple(id, Vector(motion.p_WB), Vector(motion.v_WB), Vector(motion.a_WB), ArrayOf(orientation, {4}),
                        Vector(motion.w_WB_B), weight, said, age_s);
}

py::tuple PerceivedBy(const TeamEnv& team, int id) {
  const Agent& agent = team.episodes().agent(id);
  py::list neighbours;
  for (const Heard& heard : agent.heard())
    neighbours.append(Known(heard.id, heard.motion, heard.weight, heard.message, heard.age_s));
  return py::make_tuple(Known(id, agent.measured(), 0, {}, 0), neighbours);
}

py::tuple StateOfSnapshot(const Episodes::Snapshot& snapshot) {
  py::list changes, given, events;
  for (const Override& change : snapshot.changes) changes.append(py::make_tuple(change.key, change.value));
  for (const auto& one : snapshot.given) given.append(py::make_tuple(one.tick, one.agent, one.numbers));
  for (const auto& [tick, toml] : snapshot.events) events.append(py::make_tuple(tick, toml));
  return py::make_tuple(snapshot.of, changes, snapshot.tick, given,
                        ArrayOf(snapshot.actions, {Count(snapshot.actions.size())}), events);
}

Episodes::Snapshot SnapshotOf(const py::tuple& state) {
  Episodes::Snapshot snapshot{.of = state[0].cast<std::uint64_t>(),
                              .changes = OverridesOf(state[1].cast<Sets>()),
                              .tick = state[2].cast<std::int64_t>()};
  for (const auto& [tick, agent, numbers] : state[3].cast<std::vector<std::tuple<std::int64_t, int, std::size_t>>>())
    snapshot.given.push_back({.tick = tick, .agent = agent, .numbers = numbers});
  const auto actions = state[4].cast<Doubles>();
  snapshot.actions.assign(actions.data(), actions.data() + actions.size());
  for (const auto& [tick, toml] : state[5].cast<std::vector<std::pair<std::int64_t, std::string>>>())
    snapshot.events.push_back({tick, toml});
  return snapshot;
}

void BindTeamEnv(py::module_& module) {
  py::class_<Episodes::Snapshot>(module, "Snapshot", "An episode so far; restore() of an environment flies it again.")
      .def_readonly("tick", &Episodes::Snapshot::tick)
      .def(py::pickle(&StateOfSnapshot, &SnapshotOf));

  using Env = OneAtATime<TeamEnv>;
  const auto alone = [](auto method) { return Alone<TeamEnv>(method); };
  using Owned = std::unique_ptr<Env, Delete>;
  py::class_<Env, Owned>(module, "TeamEnv")
      .def(py::init([](const std::string& path, const Sets& sets) {
        return Compute([&] { return Owned(new Env(ReadInput(path), NameOfInput(path), OverridesOf(sets))); });
      }))
      .def("about", alone(&AboutTeam))
      .def("reset", alone([](TeamEnv& team, std::optional<std::uint64_t> seed, const std::optional<Sets>& sets) {
             Compute([&] { team.Reset(seed, OverridesOf(sets)); });
           }))
      .def("step", alone([](TeamEnv& team, const Doubles& actions, const Bools& given) {
             const auto numbers = Numbers(actions, team.agents().size() * team.action_size());
             const std::vector<char> which = CharsOf(given);
             ComputeOrWait([&] { team.Step(numbers, which); });
           }))
      .def("go_on", alone([](TeamEnv& team) { ComputeOrWait([&] { team.Step(); }); }))
      .def("act", alone([](TeamEnv& team, int id, const Doubles& action) {
             team.Act(id, {action.data(), static_cast<std::size_t>(action.size())});
           }))
      .def("take", alone([](TeamEnv& team, const std::string& event) { Compute([&] { team.Take(event); }); }))
      .def("observations", alone(&ObservationsOf))
      .def("state", alone(&StateOf))
      .def("lost", alone(&LostOf))
      .def("perceived", alone(&PerceivedBy))
      .def("disagreement_m", alone([](TeamEnv& team) { return team.disagreement_m(); }))
      .def_property_readonly("seed", alone([](TeamEnv& team) { return team.seed(); }))
      .def_property_readonly("tick", alone([](TeamEnv& team) { return team.episodes().tick(); }))
      .def_property_readonly("time_s",
                             alone([](TeamEnv& team) { return team.experiment().time_s(team.episodes().tick()); }))
      .def_property_readonly("is_at_end", alone([](TeamEnv& team) { return team.is_at_end(); }))
      .def_property_readonly("is_over", alone([](TeamEnv& team) { return team.is_over(); }))
      .def_property_readonly("is_terminated", alone(&IsTerminated))
      .def_property_readonly("failure", alone([](TeamEnv& team) { return team.failure(); }))
      .def("record",
           alone([](TeamEnv& team, const std::string& argument, const std::optional<std::string>& out, bool force) {
             return Compute([&] { return team.Record(out, force, WordsFor(argument)); });
           }))
      .def("view", alone([](TeamEnv& team, const std::string& at, double pace) {
             return Compute([&] {
               return team.View({.at = ReadLiveAddress(at, "at"),
                                 .pace = pace,
                                 .may_wait = MayGoOn,
                                 .log = [](const std::string& line) { fmt::print(stderr, "mascot: {}\n", line); }});
             });
           }))
      .def("finish", alone([](TeamEnv& team) { Compute([&] { team.Finish(); }); }))
      .def("close", alone([](TeamEnv& team) { Compute([&] { team.Close(); }); }))
      .def("save", alone([](TeamEnv& team) { return team.Save(); }))
      .def("restore",
           alone([](TeamEnv& team, const Episodes::Snapshot& snapshot) { Compute([&] { team.Restore(snapshot); }); }));
}

// --- many environments --------------------------------------------------------------------------------

/// A new array for what all environments observe, and where it begins.
template <class Number>
std::pair<py::array, TeamVector::Observations> NewObservations(const TeamVector& vector) {
  const TeamEnv& team = vector.first();
  py::array_t<Number> array({Count(vector.size()), Count(team.agents().size()), Count(team.layout().size())});
  const std::span<Number> numbers(array.mutable_data(), static_cast<std::size_t>(array.size()));
  return {std::move(array), numbers};
}

std::pair<py::array, TeamVector::Observations> NewObservations(const TeamVector& vector, bool in_floats) {
  return in_floats ? NewObservations<float>(vector) : NewObservations<double>(vector);
}

/// What the last step has led to: `observations`, disagreement, terminated, truncated, reset at this step; then whether
/// there are environments of the last three kinds, and whether some agent is lost.
py::tuple OutcomeOf(const TeamVector& vector, py::array observations) {
  const auto envs = Count(vector.size());
  py::array_t<double> disagreement(envs);
  py::array_t<bool> terminated(envs), truncated(envs), was_reset(envs);
  bool any_is_over = false, any_was_reset = false, any_is_lost = false;
  for (std::size_t env = 0; env < vector.size(); ++env) {
    const TeamVector::Reached& reached = vector.reached(env);
    disagreement.mutable_data()[env] = reached.disagreement_m;
    terminated.mutable_data()[env] = reached.terminated;
    truncated.mutable_data()[env] = reached.truncated;
    was_reset.mutable_data()[env] = reached.was_reset;
    any_is_over = any_is_over || reached.terminated || reached.truncated;
    any_was_reset = any_was_reset || reached.was_reset;
    any_is_lost = any_is_lost || reached.any_is_lost;
  }
  return py::make_tuple(std::move(observations), disagreement, terminated, truncated, was_reset, any_is_over,
                        any_was_reset, any_is_lost);
}

/// The true states of the teams of all environments at the tick that the last step has reached.
py::array_t<double> ReachedStates(const TeamVector& vector) {
  py::array_t<double> states(
      {Count(vector.size()), py::ssize_t{vector.first().experiment().size()}, Count(kStateNumbers)});
  double* to = states.mutable_data();
  for (std::size_t env = 0; env < vector.size(); ++env) to = std::ranges::copy(vector.reached(env).state, to).out;
  return states;
}

py::array_t<bool> ReachedLosses(const TeamVector& vector) {
  py::array_t<bool> lost({Count(vector.size()), Count(vector.first().agents().size())});
  bool* to = lost.mutable_data();
  for (std::size_t env = 0; env < vector.size(); ++env) to = std::ranges::copy(vector.reached(env).is_lost, to).out;
  return lost;
}

/// What an environment observed at the end of its episode; None: it was not reset at this step.
py::object FinalObservations(const TeamVector& vector, std::size_t env) {
  const TeamVector::Reached& reached = vector.reached(env);
  const TeamEnv& team = vector.first();
  if (!reached.was_reset || reached.observations.empty()) return py::none();
  return ArrayOf(reached.observations, {Count(team.agents().size()), Count(team.layout().size())});
}

void BindTeamVector(py::module_& module) {
  py::enum_<TeamVector::Autoreset>(module, "Autoreset")
      .value("NEXT_STEP", TeamVector::Autoreset::kNextStep)
      .value("SAME_STEP", TeamVector::Autoreset::kSameStep)
      .value("DISABLED", TeamVector::Autoreset::kDisabled);

  using Vector = OneAtATime<TeamVector>;
  const auto alone = [](auto method) { return Alone<TeamVector>(method); };
  using Owned = std::unique_ptr<Vector, Delete>;
  py::class_<Vector, Owned>(module, "TeamVector")
      .def(py::init([](const std::string& path, const Sets& sets, int count, int threads,
                       TeamVector::Autoreset autoreset, bool keeps_states) {
        return Compute([&] {
          return Owned(new Vector(ReadInput(path), NameOfInput(path), OverridesOf(sets), count, threads, autoreset,
                                  keeps_states));
        });
      }))
      .def("about", alone([](TeamVector& vector) { return AboutTeam(vector.first()); }))
      .def("reset", alone([](TeamVector& vector, const std::vector<std::optional<std::uint64_t>>& seeds,
                             const std::optional<Sets>& sets, const Bools& mask, bool in_floats) {
             const std::vector<char> which = CharsOf(mask);
             const auto observations = NewObservations(vector, in_floats);
             Compute([&] { vector.Reset(seeds, OverridesOf(sets), which, observations.second); });
             return observations.first;
           }))
      .def("step", alone([](TeamVector& vector, const Doubles& actions, bool in_floats) {
             const TeamEnv& team = vector.first();
             const auto numbers = Numbers(actions, vector.size() * team.agents().size() * team.action_size());
             if (!std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); }))
               throw py::value_error("actions: expected finite numbers");
             auto observations = NewObservations(vector, in_floats);
             Compute([&] { vector.Step(numbers, observations.second); });
             return OutcomeOf(vector, std::move(observations.first));
           }))
      .def("reached_states", alone(&ReachedStates))
      .def("reached_losses", alone(&ReachedLosses))
      .def("final_observations", alone(&FinalObservations))
      .def("failure", alone([](TeamVector& vector, std::size_t env) { return vector.reached(env).failure; }))
      .def("state", alone([](TeamVector& vector, std::size_t env) { return StateOf(vector.at(env)); }))
      .def("seed", alone([](TeamVector& vector, std::size_t env) { return vector.at(env).seed(); }))
      .def("record", alone([](TeamVector& vector, std::size_t env, const std::string& argument, const std::string& out,
                              bool force) {
             return Compute([&] { return vector.at(env).Record(out, force, WordsFor(argument)); });
           }))
      .def("finish", alone([](TeamVector& vector) {
             Compute([&] {
               for (std::size_t env = 0; env < vector.size(); ++env) vector.at(env).Finish();
             });
           }));
}

// --- policies -------------------------------------------------------------------------------------------

/// A network as agents compute it.
class Policy {
 public:
  explicit Policy(const std::string& path)
      : network_(Network::FromOnnx(ReadInput(path))), scratch_(network_.MakeScratch()) {}
  const Network& network() const { return network_; }
  /// The answers to rows of numbers.
  py::array_t<double> Answer(const Doubles& rows) {
    const auto inputs = Count(network_.inputs()), outputs = Count(network_.outputs());
    if (rows.ndim() != 2 || rows.shape(1) != inputs)
      throw py::value_error("expected rows of " + std::to_string(inputs) + " numbers");
    py::array_t<double> answers({rows.shape(0), outputs});
    const SameFloatingPoint same;
    for (py::ssize_t row = 0; row < rows.shape(0); ++row)
      std::ranges::copy(network_.Answer({rows.data(row, 0), network_.inputs()}, scratch_),
                        answers.mutable_data(row, 0));
    return answers;
  }

 private:
  const Network network_;
  Network::Scratch scratch_;
};

void BindPolicy(py::module_& module) {
  py::class_<Policy>(module, "Policy")
      .def(py::init<const std::string&>())
      .def("answer", &Policy::Answer)
      .def_property_readonly("inputs", [](const Policy& policy) { return policy.network().inputs(); })
      .def_property_readonly("outputs", [](const Policy& policy) { return policy.network().outputs(); })
      .def_property_readonly("metadata", [](const Policy& policy) { return policy.network().metadata(); });
}

// --- whole runs -----------------------------------------------------------------------------------------

/// Flies an experiment by its own laws, and records it. Returns the run's folder.
std::string Fly(const std::string& path, const Sets& sets, const std::optional<std::string>& out, bool force) {
  EngineResult result;
  std::string folder;
  ComputeOrWait([&] {
    const Experiment experiment = LoadExperiment(ReadInput(path), NameOfInput(path), OverridesOf(sets));
    RefuseActions(experiment);
    RefuseInProcess(experiment, path);
    EpisodeRecord record(out, experiment, force, WordsFor("out"));
    result = RunInProcess(experiment, record.Begin(experiment), MayGoOn);
    record.End(result);
    folder = record.folder().string();
  });
  if (!result.failure.empty()) throw std::runtime_error(result.failure);
  return folder;
}

/// The arrays of a recording, by name, and the words for what is missing.
py::tuple ArraysOf(const std::string& run) {
  std::unique_ptr<const Recording> recording;
  std::unique_ptr<RunArrays> arrays;
  Compute([&] {
    recording = std::make_unique<const Recording>(run);
    arrays = std::make_unique<RunArrays>(recording->agents(), recording->rate_hz());
    DecodedRow decoded(recording->agents());
    recording->ForEachRow([&](const Row& row) {
      Decode(row, decoded);
      arrays->Add(row.tick, decoded);
    });
  });
  py::dict all;
  for (const RunArray& array : arrays->All()) {
    const auto kind = std::ranges::find(kStateArrays, array.name, &StateArray::name);
    if (kind != kStateArrays.end() && kind->of_command && !recording->has_commands()) continue;
    const std::vector<py::ssize_t> shape(array.shape.begin(), array.shape.end());
    py::object values = ArrayOf(array.values, shape);
    if (array.of_integers) values = values.attr("astype")("int64");
    all[py::str(array.name)] = values;
  }
  return py::make_tuple(recording->path(), all, recording->loss());
}

}  // namespace
}  // namespace mascot

PYBIND11_MODULE(_mascot, module) {
  using namespace mascot;
  py::module_::import("os").attr("register_at_fork")(py::arg("after_in_child") = py::cpp_function(&OnFork));
  py::module_::import("atexit").attr("register")(py::cpp_function(&OnEndOfInterpreter));
  py::register_exception<ConfigError>(module, "ConfigError", PyExc_ValueError);
  BindTeamEnv(module);
  BindTeamVector(module);
  BindPolicy(module);
  py::register_exception<NetworkError>(module, "NetworkError", PyExc_ValueError);
  module.def("fly", &Fly);
  module.def("arrays", &ArraysOf);
}
