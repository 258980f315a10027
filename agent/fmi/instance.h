#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "agent/fmi/model_description.h"
#include "agent/fmi/numbers.h"

namespace mascot {

/// Strings of one variable.
struct FmuTexts {
  std::uint32_t reference = 0;
  std::vector<std::string> texts;
};

/// Values that parameters, and inputs which stay as they are, have instead of their start values.
struct FmuSettings {
  std::vector<FmuNumbers> structural;  ///< of FMI 3: they fix the sizes of arrays, and are set first
  std::vector<FmuNumbers> numbers;
  std::vector<FmuTexts> texts;
};

/// Takes what an FMU says, a line at a time: "warning (logEvents): the words".
using FmuLog = std::function<void(const std::string& line)>;

/// One instance of an FMU for co-simulation. The calls are made in this order: Begin, Set for inputs, Start, then for
/// each step Set, Step, Get. All throw FmuError ("fmi2DoStep: error: the words that the FMU logged").
class FmuInstance {
 public:
  virtual ~FmuInstance() = default;
  /// Gives parameters their values and begins the initialisation, at time 0 and without an end.
  virtual void Begin(const FmuSettings& settings) = 0;
  /// Ends the initialisation.
  virtual void Start() = 0;
  virtual void Set(FmuNumbers& numbers) = 0;
  virtual void Set(const FmuTexts& texts) = 0;
  virtual void Get(FmuNumbers& numbers) = 0;
  /// Steps from `t_s` to `t_s + step_s`.
  virtual void Step(double t_s, double step_s) = 0;
};

/// A library of an FMU that has been loaded, and what its instances are told.
struct FmuLibrary {
  void* handle = nullptr;         ///< of dlopen
  const ModelDescription& model;  ///< must outlive all instances
  std::string resources;          ///< absolute path of the folder resources, ending in '/'; it may be empty
  /// Whether an instance has had a fatal error: then no function of the library may be called again.
  std::shared_ptr<std::atomic<bool>> is_dead = std::make_shared<std::atomic<bool>>(false);
};

/// Makes an instance of an FMU of FMI 2, or of FMI 3. `name`: what the FMU is told to be. Throws FmuError.
std::unique_ptr<FmuInstance> MakeFmi2Instance(const FmuLibrary& library, const std::string& name, FmuLog log);
std::unique_ptr<FmuInstance> MakeFmi3Instance(const FmuLibrary& library, const std::string& name, FmuLog log);

}  // namespace mascot
