#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mascot {

enum class FmuType {
  kFloat64,  ///< Real of FMI 2
  kFloat32,
  kInt8,
  kUInt8,
  kInt16,
  kUInt16,
  kInt32,  ///< Integer and Enumeration of FMI 2
  kUInt32,
  kInt64,  ///< and Enumeration of FMI 3
  kUInt64,
  kBoolean,
  kString,
  kOther  ///< Binary, Clock: neither read nor set here
};

enum class FmuCausality { kInput, kOutput, kParameter, kStructuralParameter, kOther };
enum class FmuVariability { kFixed, kTunable, kOther };

/// The extent of an array: a number, or the value of a structural parameter.
struct FmuDimension {
  std::size_t size = 1;  ///< with the parameter's start value
  std::optional<std::uint32_t> parameter = {};
};

struct FmuVariable {
  std::string name;
  std::uint32_t reference = 0;
  FmuType type = FmuType::kOther;
  FmuCausality causality = FmuCausality::kOther;
  FmuVariability variability = FmuVariability::kOther;
  bool has_start = false;
  std::vector<FmuDimension> dimensions = {};  ///< empty: one value

  bool is_number() const { return type != FmuType::kString && type != FmuType::kOther; }
  /// The number of values, with structural parameters at their start values.
  std::size_t size() const;
};

/// What modelDescription.xml says of an FMU for co-simulation.
struct ModelDescription {
  static constexpr std::size_t kMaxBytes = std::size_t{16} << 20;
  static constexpr std::size_t kMaxArray = 100'000;  ///< values of an array

  /// Throws FmuError if the text is no such description, or if the FMU is none for co-simulation.
  static ModelDescription FromXml(const std::string& text);

  int version = 0;               ///< of FMI: 2 or 3
  std::string model_identifier;  ///< name of the library, without its ending: a name in C
  std::string token;             ///< guid of FMI 2, instantiationToken of FMI 3
  bool once_per_process = false;
  bool handles_variable_steps = false;
  std::optional<double> fixed_step_s = {};         ///< fixedInternalStepSize, or the stepSize of DefaultExperiment
  std::vector<std::string> error_categories = {};  ///< of LogCategories: those for warnings and errors
  std::vector<FmuVariable> variables = {};

  /// Null: no variable has this name.
  const FmuVariable* Find(std::string_view name) const;
};

}  // namespace mascot
