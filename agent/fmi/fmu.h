#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "agent/fmi/instance.h"
#include "agent/fmi/model_description.h"

namespace mascot {

/// An FMU for co-simulation on this platform. Its library is loaded for the first instance, from a private folder of
/// the process, and stays loaded until the process ends.
class Fmu {
 public:
  static constexpr std::size_t kMaxFile = std::size_t{256} << 20;  ///< bytes of the file of an FMU

  /// What this platform needs of an FMU, as an archive: modelDescription.xml, the libraries for this platform, and
  /// resources. The same archive gives the same bytes. Throws FmuError.
  static std::string Pack(std::string archive);
  /// Reads an archive, packed or not. As long as the process has an FMU of these bytes, it is the same object. Several
  /// threads may call it. Throws FmuError.
  static std::shared_ptr<const Fmu> Of(const std::string& archive);

  virtual ~Fmu() = default;
  virtual const ModelDescription& model() const = 0;
  /// Makes an instance that is called `name`. Throws FmuError; also if the process has an instance, and the FMU says
  /// that a process can have only one, or if an instance has had a fatal error. The instance keeps the FMU alive.
  virtual std::unique_ptr<FmuInstance> Instantiate(const std::string& name, FmuLog log) const = 0;
};

}  // namespace mascot
