// [law.params] of an FMU: values of its parameters.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "agent/laws/fmu/fmu_law.h"
#include "base/utf8.h"

namespace mascot {
namespace {

constexpr double kMaxInteger = 9007199254740992;  // beyond it, not every integer is a double

/// A value of [law.params] that is no table: its dotted key, and its numbers or strings, row by row.
struct GivenValue {
  std::string key;
  std::vector<const Value*> items;
};

void Flatten(const Value& value, std::vector<const Value*>& items) {
  if (const auto* list = std::get_if<Value::List>(&value.data))
    for (const Value& item : *list) Flatten(item, items);
  else
    items.push_back(&value);
}

void Collect(const Value& table, const std::string& prefix, std::vector<GivenValue>& given) {
  for (const auto& [key, value] : std::get<Value::Table>(table.data)) {
    if (std::holds_alternative<Value::Table>(value.data)) {
      Collect(value, prefix + key + ".", given);
      continue;
    }
    GivenValue one{prefix + key, {}};
    Flatten(value, one.items);
    given.push_back(std::move(one));
  }
}

bool IsInteger(FmuType type) { return type >= FmuType::kInt8 && type <= FmuType::kUInt64; }

/// What values of a type are, for messages.
std::string Expected(FmuType type) {
  if (type == FmuType::kBoolean) return "true or false";
  if (type == FmuType::kString) return "a string";
  return IsInteger(type) ? "an integer that fits its type" : "a number";
}

bool FitsInteger(FmuType type, double number) {
  if (!(std::abs(number) <= kMaxInteger) || number != std::floor(number)) return false;
  bool fits = false;
  VisitNumberType(type, [&]<class T>(T) {
    if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>)
      fits = number >= static_cast<double>(std::numeric_limits<T>::min()) &&
             number <= static_cast<double>(std::numeric_limits<T>::max());
  });
  return fits;
}

/// Appends the value to the parameter's; false if it is of another type.
bool Take(const Value& value, FmuParameter& parameter) {
  if (parameter.type == FmuType::kString) {
    const auto* text = std::get_if<std::string>(&value.data);
    if (text == nullptr || text->find('\0') != std::string::npos) return false;
    parameter.texts.push_back(*text);
    return true;
  }
  if (parameter.type == FmuType::kBoolean) {
    const auto* boolean = std::get_if<bool>(&value.data);
    if (boolean == nullptr) return false;
    parameter.numbers.push_back(*boolean ? 1 : 0);
    return true;
  }
  const bool is_integer = std::holds_alternative<std::int64_t>(value.data);
  if (!is_integer && !std::holds_alternative<double>(value.data)) return false;
  const double number = value.Number();
  if (IsInteger(parameter.type) && (!is_integer || !FitsInteger(parameter.type, number))) return false;
  parameter.numbers.push_back(number);
  return true;
}

bool MayBeGiven(const FmuVariable& variable) {
  return variable.type != FmuType::kOther &&
         (variable.causality == FmuCausality::kParameter || variable.causality == FmuCausality::kInput ||
          variable.causality == FmuCausality::kStructuralParameter);
}

FmuParameter Begun(const FmuVariable& variable) {
  return {.name = variable.name,
          .reference = variable.reference,
          .type = variable.type,
          .causality = variable.causality,
          .is_tunable =
              variable.causality == FmuCausality::kInput ||
              (variable.causality == FmuCausality::kParameter && variable.variability == FmuVariability::kTunable)};
}

/// What a name that is no variable's stands for: an array of scalar variables. Empty: nothing.
std::vector<FmuElement> ElementsNamed(const ModelDescription& model, const std::string& name) {
  const FmuVariables variables(model, {});
  for (const FmuCausality causality :
       {FmuCausality::kParameter, FmuCausality::kStructuralParameter, FmuCausality::kInput})
    if (auto elements = variables.Named(causality, name); !elements.empty()) return elements;
  return {};
}

class ParameterReader {
 public:
  ParameterReader(const ModelDescription& model, Section& law) : model_(model), law_(law) {}

  std::vector<FmuParameter> Read(const Value& table) {
    std::vector<GivenValue> given;
    Collect(table, "", given);
    for (const GivenValue& one : given) ReadOne(one);
    CheckSizes();
    return std::move(parameters_);
  }

 private:
  void ReadOne(const GivenValue& given) {
    if (const FmuVariable* variable = model_.Find(given.key); variable != nullptr && MayBeGiven(*variable)) {
      Add(given.key, *variable, given.items);
      return;
    }
    const auto elements = ElementsNamed(model_, given.key);
    const bool are_scalars =
        std::ranges::all_of(elements, [](const FmuElement& one) { return one.variable->dimensions.empty(); });
    if (elements.empty() || !are_scalars) return FailUnknown(given.key);
    if (elements.size() != given.items.size())
      return law_.FailInside("params", given.key,
                             fmt::format("expected {} values, got {}", elements.size(), given.items.size()));
    for (std::size_t k = 0; k < elements.size(); ++k) Add(given.key, *elements[k].variable, {&given.items[k], 1});
  }

  void Add(const std::string& key, const FmuVariable& variable, std::span<const Value* const> items) {
    FmuParameter parameter = Begun(variable);
    for (const Value* item : items)
      if (!Take(*item, parameter))
        return law_.FailInside("params", key,
                               fmt::format("expected {}, got {}", Expected(variable.type), ToToml(*item)));
    const auto same = [&](const FmuParameter& other) { return other.name == variable.name; };
    if (std::ranges::any_of(parameters_, same)) return law_.FailInside("params", key, EachOnce("value", variable.name));
    keys_.push_back(key);
    parameters_.push_back(std::move(parameter));
  }

  /// Sizes of arrays, once all structural parameters are known.
  void CheckSizes() {
    const FmuVariables variables(model_, parameters_);
    for (std::size_t k = 0; k < parameters_.size(); ++k) {
      const FmuParameter& parameter = parameters_[k];
      const std::size_t size = variables.SizeOf(*model_.Find(parameter.name));
      const std::size_t got = std::max(parameter.numbers.size(), parameter.texts.size());
      if (got != size) law_.FailInside("params", keys_[k], fmt::format("expected {} values, got {}", size, got));
    }
  }

  void FailUnknown(const std::string& key) {
    std::vector<std::string_view> names;
    for (const FmuVariable& variable : model_.variables)
      if (MayBeGiven(variable)) names.push_back(variable.name);
    law_.FailInside("params", key, "the FMU has no parameter of this name" + Suggestion(key, names));
  }

  const ModelDescription& model_;
  Section& law_;
  std::vector<FmuParameter> parameters_;
  std::vector<std::string> keys_;  // of the parameters
};

}  // namespace

std::vector<FmuParameter> ReadFmuParameters(const ModelDescription& model, Section& law) {
  if (law.Wrong("params")) return {};
  auto parameters = ParameterReader(model, law).Read(law.Free("params"));
  return law.Wrong("params") ? std::vector<FmuParameter>() : parameters;
}

FmuSettings SettingsOf(std::span<const FmuParameter> parameters) {
  FmuSettings settings;
  for (const FmuParameter& parameter : parameters) {
    if (parameter.type == FmuType::kString) {
      settings.texts.push_back({parameter.reference, parameter.texts});
      continue;
    }
    FmuNumbers numbers(parameter.type);
    numbers.Add(parameter.reference, parameter.numbers.size());
    std::ranges::copy(parameter.numbers, numbers.values().begin());
    const bool is_structural = parameter.causality == FmuCausality::kStructuralParameter;
    (is_structural ? settings.structural : settings.numbers).push_back(std::move(numbers));
  }
  return settings;
}

std::string FmuLawParams::WhyFixed(const LawParams& before) const {
  const auto* const old = dynamic_cast<const FmuLawParams*>(&before);
  if (old == nullptr) return "";
  for (const FmuParameter& parameter : parameters) {
    const auto was = std::ranges::find(old->parameters, parameter.name, &FmuParameter::name);
    const bool is_same = was != old->parameters.end() && *was == parameter;
    if (!is_same && !parameter.is_tunable)
      return "expected a change of tunable parameters of the FMU, got " + Shortened(PlainLine(parameter.name), 100) +
             ", which is fixed";
  }
  return "";
}

}  // namespace mascot
