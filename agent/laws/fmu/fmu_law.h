#pragma once

// What the files of the law that is an FMU share.

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "agent/fmi/fmu.h"
#include "agent/laws/fmu/signals.h"
#include "agent/laws/laws.h"

namespace mascot {

/// A value of [law.params] for a variable of the FMU.
struct FmuParameter {
  std::string name;  ///< of the variable
  std::uint32_t reference = 0;
  FmuType type = FmuType::kFloat64;
  FmuCausality causality = FmuCausality::kParameter;
  bool is_tunable = false;              ///< an event can change it
  std::vector<double> numbers = {};     ///< of a variable of numbers
  std::vector<std::string> texts = {};  ///< of a variable of strings

  bool operator==(const FmuParameter&) const = default;
};

/// Inputs of one type, and the signal of each of their values.
struct FmuInputs {
  FmuNumbers numbers;
  std::vector<FmuSignal> signals;
};

/// Where one number is in FmuLawParams::outputs.
struct FmuOutput {
  std::size_t group = 0, value = 0;
};

struct FmuLawParams final : LawParams {
  std::shared_ptr<const Fmu> fmu;  ///< null after a mistake
  std::string name;                ///< what messages call it
  Wanted wanted = Wanted::kAcceleration;
  std::vector<FmuInputs> inputs;
  std::vector<FmuNumbers> outputs;
  std::array<std::optional<FmuOutput>, 3> u;
  std::vector<FmuOutput> message;
  std::vector<FmuParameter> parameters;
  std::vector<std::string> warnings;

  std::string WhyFixed(const LawParams& before) const override;
};

/// One value of a variable of the FMU.
struct FmuElement {
  const FmuVariable* variable = nullptr;
  std::size_t element = 0;  ///< from 0, row by row in a matrix
};

/// The variables of one causality, with the sizes that arrays have by [law.params].
class FmuVariables {
 public:
  FmuVariables(const ModelDescription& model, std::span<const FmuParameter> parameters)
      : model_(model), parameters_(parameters) {}
  /// The number of values of a variable.
  std::size_t SizeOf(const FmuVariable& variable) const;
  /// What `name` stands for among variables of this causality: a variable and all its values; one value of an array,
  /// "y[2]"; or the variables "y[1]", "y[2]" and so on for "y". Empty: nothing.
  std::vector<FmuElement> Named(FmuCausality causality, std::string_view name) const;
  std::vector<std::string_view> Names(FmuCausality causality) const;

 private:
  std::size_t Extent(const FmuDimension& dimension) const;

  const ModelDescription& model_;
  std::span<const FmuParameter> parameters_;
};

/// "'a', 'b'", or "none".
std::string QuotedNames(std::span<const std::string_view> names);
/// " (did you mean \"p\"?)", or nothing.
std::string Suggestion(std::string_view word, std::span<const std::string_view> names);

/// Reads [law.params], a table: values of the FMU's parameters, and of inputs that are to stay as they are. Notes
/// mistakes; after one there are no values.
std::vector<FmuParameter> ReadFmuParameters(const ModelDescription& model, Section& law);
/// The parameters as instances take them.
FmuSettings SettingsOf(std::span<const FmuParameter> parameters);

/// Reads [law.fmu.inputs] and [law.fmu.outputs], and finds the others by their names. `file`: the key that mistakes of
/// the FMU itself are noted at. `places`: how many neighbours the agents have that have most.
void MapFmuSignals(const ModelDescription& model, std::size_t places, const std::string& file, Section& law,
                   FmuLawParams& params);

}  // namespace mascot
