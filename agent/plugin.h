#pragma once

// What a law in a shared library of one's own is made of ([law] name = "plugin"). docs/plugin_law.md shows how; in
// short:
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
// Frames and units are those of agent/law.h and experiment/motion.h: SI, world frame (x east, y north, z up).
//
// Life: `orchestrator check` and `up` make the law of every agent, to see whether it takes its parameters, ask it for
// its first command, and let it go again. In flight there is one object per agent, made before the first tick and gone
// after the last. All agents may live in one process, and one agent may have two objects in it (the second flies the
// ideal bodies of the fidelity figure): keep what a law remembers in its members, never in globals.
//
// Threads: one object is called by one thread at a time, two objects perhaps at once.
//
// Exceptions: the constructor may throw std::invalid_argument, as setup.params does, for parameters that it refuses;
// that is a mistake in the configuration. Any exception in flight ends the run, naming the agent and the time.
//
// The same run must give the same bytes: no clock, no file that changes, random numbers from setup.seed and setup.id.

#include <cstdint>
#include <string>
#include <type_traits>

#include "agent/law.h"
#include "agent/plugin_params.h"
#include "experiment/motion.h"
#include "experiment/toml/value.h"

namespace mascot {

/// Counts up with every change to what stands in this header or in those that it includes.
inline constexpr int kLawInterface = 1;

/// What a law is made from.
struct PluginSetup {
  int id = 0;              ///< of the agent whose law this is to be, 1..agents
  int agents = 0;          ///< of the whole experiment
  int leader = 0;          ///< law.leader; 0: none
  double rate_hz = 0;      ///< at which Want_W is called: control.rate_hz
  std::uint64_t seed = 0;  ///< run.seed
  PluginParams& params;    ///< [law.params]; lives as long as the constructor runs
};

/// One fact about how somebody compiled the types above. Plugin and program must agree on all of them, or each would
/// look for p_WB where the other has none: -mavx alone aligns Eigen's quaternions otherwise.
struct PluginFact {
  const char* name;  ///< null: the end of a list
  long long value;
};

// Of this compilation. Not inline: the linker would keep one of two lists of the same name, and compare it with itself.
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

/// The one thing that a plugin exports, as `mascot_plugin_law`. Its first member stays the first for ever.
struct PluginExport {
  int interface;            ///< kLawInterface; if it is another, nothing else is looked at
  const PluginFact* facts;  ///< kPluginFacts
  bool sends_messages;
  Law* (*make)(const PluginSetup& setup);
};

/// A law that overrides Message() sends messages.
template <class T>
inline constexpr bool kSendsMessages = !std::is_same_v<decltype(&T::Message), decltype(&Law::Message)>;

}  // namespace mascot

/// Exports the law `Type`, which is made from a `const mascot::PluginSetup&`. Once per library, outside any namespace.
#define MASCOT_PLUGIN_LAW(Type)                                                                   \
  extern "C" __attribute__((visibility("default"))) const mascot::PluginExport mascot_plugin_law; \
  const mascot::PluginExport mascot_plugin_law = {                                                \
      mascot::kLawInterface, mascot::kPluginFacts, mascot::kSendsMessages<Type>,                  \
      [](const mascot::PluginSetup& setup) -> mascot::Law* { return new Type(setup); }};
