#pragma once

// The interface of a law in a shared library of your own ([law] name = "plugin"). In short (more in
// docs/plugin_law.md):
//
//   #include "mascot/plugin.h"
//   class MyLaw final : public mascot::Law {
//    public:
//     explicit MyLaw(const mascot::PluginSetup& setup) : gain_(setup.params.Number("gain", 0, 10, 1.0)) {}
//     Eigen::Vector3d Want_W(double t_s, const mascot::Motion& self, std::span<const mascot::Heard> heard) override;
//     ...
//   };
//   MASCOT_PLUGIN_LAW(MyLaw)
//
// Frames and units are those of agent/laws/law.h and base/motion.h: SI, world frame (x east, y north, z up).
//
// Lifetime: `orchestrator check` and `up` make the law of every agent to check its parameters, ask it for its first
// command and destroy it. In a run there is one object per agent, made before the first tick and destroyed after the
// last. All agents may live in one process, and one agent may have two objects in it (the second flies the ideal bodies
// of the fidelity figure): keep the state of a law in its members, never in globals.
//
// Threads: one object is called by one thread at a time; different objects may be called at once.
//
// Events: a law may define `void Set(mascot::PluginParams& params)`. It is called before Want_W() of the tick at which
// an event has changed [law.params]; without it, such events are refused.
//
// Exceptions: for parameters that it refuses the constructor may throw std::invalid_argument, as setup.params does;
// that is a mistake in the configuration. Any exception during a run ends it, naming the agent and the time.
//
// Determinism: the same run must give the same bytes. Use no clock and no file that changes; seed random numbers with
// setup.seed and setup.id.

#include <cstdint>
#include <string>
#include <type_traits>

#include "agent/laws/law.h"
#include "agent/laws/plugin/plugin_params.h"
#include "base/motion.h"
#include "base/value.h"

namespace mascot {

/// Version of the interface: goes up with every change to this header or to those that it includes.
inline constexpr int kLawInterface = 3;

/// The argument of a law's constructor.
struct PluginSetup {
  int id = 0;              ///< the agent that the law is for, 1..agents
  int agents = 0;          ///< number of agents in the experiment
  int leader = 0;          ///< law.leader; 0: none
  double rate_hz = 0;      ///< calls of Want_W() per simulated second: control.rate_hz
  std::uint64_t seed = 0;  ///< run.seed
  PluginParams& params;    ///< [law.params]; valid only while the constructor runs
};

/// One fact about how the types above were compiled. Plugin and program must agree on all of them, or they would look
/// for p_WB in different places: -mavx alone changes the alignment of Eigen's quaternions.
struct PluginFact {
  const char* name;  ///< null: the end of a list
  long long value;
};

// The facts of this compilation. Not inline: if plugin and program had a list of the same name, the linker would keep
// one of them, and the program would compare it with itself.
constexpr PluginFact kPluginFacts[] = {
#ifdef __GLIBCXX__
    {"_GLIBCXX_USE_CXX11_ABI", _GLIBCXX_USE_CXX11_ABI},
#else
    {"_GLIBCXX_USE_CXX11_ABI", -1},  // another standard library
#endif
#ifdef _GLIBCXX_DEBUG
    {"_GLIBCXX_DEBUG", 1},
#else
    {"_GLIBCXX_DEBUG", 0},
#endif
    {"EIGEN_MAX_STATIC_ALIGN_BYTES", EIGEN_MAX_STATIC_ALIGN_BYTES},
    {"sizeof(Motion)", sizeof(Motion)},
    {"alignof(Motion)", alignof(Motion)},
    {"sizeof(Heard)", sizeof(Heard)},
    {"sizeof(PluginSetup)", sizeof(PluginSetup)},
    {"sizeof(PluginParams)", sizeof(PluginParams)},
    {"sizeof(Value)", sizeof(Value)},
    {nullptr, 0},
};

/// The only symbol that a plugin exports, as `mascot_plugin_law`. Its first member must stay the first.
struct PluginExport {
  int interface;            ///< the plugin's kLawInterface; if it differs from ours, nothing else is read
  const PluginFact* facts;  ///< kPluginFacts
  bool sends_messages;
  Law* (*make)(const PluginSetup& setup);
  /// Gives a law new parameters; null: no event can change them.
  void (*set)(Law& law, PluginParams& params);
};

/// True for a law that overrides Message(): it sends messages.
template <class T>
inline constexpr bool kSendsMessages = !std::is_same_v<decltype(&T::Message), decltype(&Law::Message)>;

/// Calls Set() of a law of type T; null if it has none.
template <class T>
constexpr auto SetOf() -> void (*)(Law&, PluginParams&) {
  if constexpr (requires(T & law, PluginParams & params) { law.Set(params); })
    return [](Law& law, PluginParams& params) { static_cast<T&>(law).Set(params); };
  else
    return nullptr;
}

}  // namespace mascot

/// Exports the law `Type`, whose constructor takes a `const mascot::PluginSetup&`. Once per library, outside any
/// namespace.
#define MASCOT_PLUGIN_LAW(Type)                                                                   \
  extern "C" __attribute__((visibility("default"))) const mascot::PluginExport mascot_plugin_law; \
  const mascot::PluginExport mascot_plugin_law = {                                                \
      mascot::kLawInterface, mascot::kPluginFacts, mascot::kSendsMessages<Type>,                  \
      [](const mascot::PluginSetup& setup) -> mascot::Law* { return new Type(setup); }, mascot::SetOf<Type>()};
