// Which inputs and outputs of an FMU are which signals.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "agent/laws/fmu/fmu_law.h"
#include "base/utf8.h"

namespace mascot {
namespace {

std::vector<std::string_view> Views(std::span<const std::string> texts) { return {texts.begin(), texts.end()}; }

class Mapper {
 public:
  Mapper(const ModelDescription& model, std::size_t places, const std::string& file, Section& law, FmuLawParams& params)
      : model_(model),
        variables_(model, params.parameters),
        signal_names_(SignalNames(places)),
        places_(places),
        file_(file),
        law_(law),
        tables_(law.Child("fmu")),
        params_(params) {}

  void MapInputs() {
    std::map<std::string, std::string> table = Table("inputs");
    for (const auto& [name, signal] : table) MapInput(name, signal);
    for (const FmuVariable& variable : model_.variables)
      if (variable.causality == FmuCausality::kInput) MapByName(variable);
    for (auto& [variable, signals] : inputs_) AddInput(*variable, signals);
    WarnOfPlaces();
  }

  void MapOutputs() {
    const auto names = variables_.Names(FmuCausality::kOutput);
    std::map<std::size_t, FmuElement> u, message, u_by_name, message_by_name;
    for (const auto& [target, name] : Table("outputs")) {
      const auto elements = variables_.Named(FmuCausality::kOutput, name);
      if (elements.empty())
        tables_.FailInside("outputs", target,
                           "the FMU has no output '" + Shortened(PlainLine(name), 100) + "'" + Suggestion(name, names) +
                               "; it has " + QuotedNames(names));
      else if (const std::string mistake = Place(target, elements, u, message); !mistake.empty())
        tables_.FailInside("outputs", target, mistake);
    }
    for (const std::string_view name : names) {
      if (!IsOfLaw(name)) continue;
      const auto elements = variables_.Named(FmuCausality::kOutput, name);
      if (const std::string mistake = Place(name, elements, u_by_name, message_by_name); !mistake.empty())
        law_.Fail(file_, fmt::format("expected an FMU whose output '{}' can be used, got {}: {}", PlainLine(name),
                                     params_.name, mistake));
    }
    if (law_.Wrong("")) return;
    u.merge(u_by_name);  // the table goes first
    message.merge(message_by_name);
    TakeU(u);
    TakeMessage(message);
  }

  void Done() { tables_.Done(); }

 private:
  /// A table of strings.
  std::map<std::string, std::string> Table(const char* key) {
    std::map<std::string, std::string> texts;
    const Value table = tables_.Free(key);
    const auto* entries = std::get_if<Value::Table>(&table.data);
    if (entries == nullptr) tables_.Fail(key, "expected a table, got a " + tables_.Kind(key));
    if (entries == nullptr) return texts;
    for (const auto& [name, value] : *entries) {
      if (const auto* text = std::get_if<std::string>(&value.data))
        texts[name] = *text;
      else
        tables_.FailInside(key, name, "expected the name of a signal or variable in quotes, got " + ToToml(value));
    }
    return texts;
  }

  // --- inputs ---

  void MapInput(const std::string& name, const std::string& signal) {
    const auto elements = variables_.Named(FmuCausality::kInput, name);
    const auto names = variables_.Names(FmuCausality::kInput);
    if (elements.empty())
      return tables_.FailInside(
          "inputs", name,
          "the FMU has no input of this name" + Suggestion(name, names) + "; it has " + QuotedNames(names));
    const auto signals = SignalsOf(signal, elements.size());
    if (!signals)
      return tables_.FailInside(
          "inputs", name,
          "there is no signal '" + Shortened(PlainLine(signal), 100) + "'" + Suggestion(signal, Views(signal_names_)));
    if (signals->empty())
      return tables_.FailInside(
          "inputs", name, fmt::format("expected a signal of {} numbers, got {}", elements.size(), PlainLine(signal)));
    for (std::size_t k = 0; k < elements.size(); ++k) {
      const FmuVariable& variable = *elements[k].variable;
      if (!variable.is_number())
        return tables_.FailInside("inputs", name, "expected an input of numbers, got one of another type");
      auto& mapped = inputs_[&variable];
      mapped.resize(variables_.SizeOf(variable));
      mapped[elements[k].element] = (*signals)[k];
    }
  }

  void MapByName(const FmuVariable& variable) {
    const auto mapped = inputs_.find(&variable);
    const bool has_value =
        std::ranges::find(params_.parameters, variable.name, &FmuParameter::name) != params_.parameters.end();
    if (mapped != inputs_.end()) {
      if (has_value) FailFile(variable, "has a signal in law.fmu.inputs and a value in law.params");
      return;
    }
    const std::size_t size = variables_.SizeOf(variable);
    const auto signals = SignalsOf(variable.name, size);
    if (has_value) return;
    if (signals && variable.is_number() && !signals->empty()) {
      inputs_[&variable] = {signals->begin(), signals->end()};
      return;
    }
    constexpr const char* kAdvice = ": give it a signal in [law.fmu.inputs], or a value in [law.params]";
    if (signals && variable.is_number())
      return FailFile(variable, fmt::format("has {} numbers, which its signal has not{}", size, kAdvice));
    const std::string hint = Suggestion(variable.name, Views(signal_names_));
    const bool needs_value = !variable.has_start && variable.type != FmuType::kOther;  // others cannot be given one
    if (needs_value || (!hint.empty() && variable.name.size() >= 4))
      return FailFile(variable, "is no signal" + hint + kAdvice);
    params_.warnings.push_back(fmt::format("input '{}' of {} is no signal, and keeps its start value",
                                           Shortened(PlainLine(variable.name), 100), params_.name));
  }

  void AddInput(const FmuVariable& variable, const std::vector<std::optional<FmuSignal>>& signals) {
    if (std::ranges::any_of(signals, [](const auto& signal) { return !signal; }))
      return FailFile(variable, "has a signal for some of its numbers in law.fmu.inputs, and not for all");
    auto group =
        std::ranges::find(params_.inputs, variable.type, [](const FmuInputs& inputs) { return inputs.numbers.type(); });
    if (group == params_.inputs.end()) {
      params_.inputs.push_back({FmuNumbers(variable.type), {}});
      group = params_.inputs.end() - 1;
    }
    group->numbers.Add(variable.reference, signals.size());
    for (const auto& signal : signals) group->signals.push_back(*signal);
  }

  void WarnOfPlaces() {
    std::size_t seen = 0;
    for (const FmuInputs& inputs : params_.inputs)
      for (const FmuSignal& signal : inputs.signals)
        if (signal.is_of_neighbour()) seen = std::max(seen, signal.place + 1);
    if (seen > 0 && seen < places_)
      params_.warnings.push_back(
          fmt::format("{} has inputs for {} neighbours, and agents hear up to {}", params_.name, seen, places_));
  }

  // --- outputs ---

  static bool IsOfLaw(std::string_view name) {
    const auto indexed = WithoutIndex(name, "xyz");
    return indexed && (indexed->name == "u" || indexed->name == "message");
  }

  /// Puts the values of outputs where the law's own output `target` has them. Returns what is wrong; empty: nothing.
  static std::string Place(std::string_view target, const std::vector<FmuElement>& elements,
                           std::map<std::size_t, FmuElement>& u, std::map<std::size_t, FmuElement>& message) {
    const auto indexed = WithoutIndex(target, "xyz");
    const auto index = indexed ? PlaceInVector(indexed->indices) : std::nullopt;
    const bool is_whole = indexed && indexed->indices.empty();
    if (!indexed || (indexed->name != "u" && indexed->name != "message") || !(is_whole || index)) {
      constexpr std::string_view kOurs[] = {"u", "u[1]", "u[2]", "u[3]", "message", "message[1]"};
      return "the law has no output of this name" + Suggestion(target, kOurs) + "; it has " + QuotedNames(kOurs);
    }
    auto& places = indexed->name == "u" ? u : message;
    const std::size_t most = indexed->name == "u" ? 3 : kMaxMessage;
    if (index && elements.size() != 1) return fmt::format("expected an output of one number, got {}", elements.size());
    for (std::size_t k = 0; k < elements.size(); ++k) {
      const std::size_t place = index.value_or(k);
      if (place >= most) return fmt::format("expected at most {} numbers, got more", most);
      if (!elements[k].variable->is_number()) return "expected numbers, got a variable of another type";
      if (!places.emplace(place, elements[k]).second) return "it stands for a number that another output gives";
    }
    return "";
  }

  FmuOutput Output(const FmuElement& element) {
    auto first = first_of_.find(element.variable);
    if (first == first_of_.end()) {
      const FmuType type = element.variable->type;
      auto group = std::ranges::find(params_.outputs, type, &FmuNumbers::type);
      if (group == params_.outputs.end()) {
        params_.outputs.emplace_back(type);
        group = params_.outputs.end() - 1;
      }
      const auto number = static_cast<std::size_t>(group - params_.outputs.begin());
      const std::size_t value = group->Add(element.variable->reference, variables_.SizeOf(*element.variable));
      first = first_of_.emplace(element.variable, FmuOutput{number, value}).first;
    }
    return {first->second.group, first->second.value + element.element};
  }

  void TakeU(const std::map<std::size_t, FmuElement>& u) {
    if (!u.contains(0) || !u.contains(1)) {
      law_.Fail(file_, fmt::format("expected an FMU with outputs u[1], u[2] and perhaps u[3], or those that "
                                   "[law.fmu.outputs] names, got {} with {}",
                                   params_.name, QuotedNames(variables_.Names(FmuCausality::kOutput))));
      return;
    }
    for (const auto& [place, element] : u) params_.u[place] = Output(element);
  }

  void TakeMessage(const std::map<std::size_t, FmuElement>& message) {
    std::size_t next = 0;
    for (const auto& [place, element] : message) {
      if (place != next++) {
        law_.Fail(file_, fmt::format("expected an FMU with an output for each number of the message, got {} without "
                                     "message[{}]",
                                     params_.name, next));
        return;
      }
      params_.message.push_back(Output(element));
    }
    params_.sends_messages = !params_.message.empty();
  }

  void FailFile(const FmuVariable& variable, const std::string& words) {
    law_.Fail(file_, fmt::format("expected an FMU whose inputs are signals, got {}: input '{}' {}", params_.name,
                                 Shortened(PlainLine(variable.name), 100), words));
  }

  const ModelDescription& model_;
  const FmuVariables variables_;
  const std::vector<std::string> signal_names_;
  const std::size_t places_;
  const std::string& file_;
  Section& law_;
  Section tables_;
  FmuLawParams& params_;
  std::map<const FmuVariable*, std::vector<std::optional<FmuSignal>>> inputs_;
  std::map<const FmuVariable*, FmuOutput> first_of_;
};

}  // namespace

std::size_t FmuVariables::Extent(const FmuDimension& dimension) const {
  if (!dimension.parameter) return dimension.size;
  const auto given = std::ranges::find_if(parameters_, [&](const FmuParameter& parameter) {
    return parameter.causality == FmuCausality::kStructuralParameter && parameter.reference == *dimension.parameter &&
           !parameter.numbers.empty();
  });
  if (given == parameters_.end()) return dimension.size;
  return static_cast<std::size_t>(std::clamp(given->numbers.front(), 0.0, double{ModelDescription::kMaxArray}));
}

std::size_t FmuVariables::SizeOf(const FmuVariable& variable) const {
  std::size_t size = 1;
  for (const FmuDimension& dimension : variable.dimensions)
    size = std::min(size * Extent(dimension), ModelDescription::kMaxArray);
  return size;
}

std::vector<FmuElement> FmuVariables::Named(FmuCausality causality, std::string_view name) const {
  const auto of_causality = [&](const FmuVariable* variable) {
    return variable != nullptr && variable->causality == causality;
  };
  std::vector<FmuElement> elements;
  if (const FmuVariable* const whole = model_.Find(name); of_causality(whole)) {
    for (std::size_t k = 0; k < SizeOf(*whole); ++k) elements.push_back({whole, k});
    return elements;
  }
  if (const auto indexed = WithoutBrackets(name); indexed && !indexed->indices.empty()) {
    const FmuVariable* const array = model_.Find(indexed->name);
    if (!of_causality(array) || array->dimensions.size() != indexed->indices.size()) return {};
    std::size_t element = 0;
    for (std::size_t k = 0; k < indexed->indices.size(); ++k) {
      if (indexed->indices[k] >= Extent(array->dimensions[k])) return {};
      element = element * Extent(array->dimensions[k]) + indexed->indices[k];
    }
    return {{array, element}};
  }
  for (std::size_t k = 1;; ++k) {
    const FmuVariable* const one = model_.Find(fmt::format("{}[{}]", name, k));
    if (!of_causality(one) || !one->dimensions.empty()) break;
    elements.push_back({one, 0});
  }
  if (!elements.empty()) return elements;
  for (std::size_t row = 1;; ++row) {  // a matrix, row by row
    const std::size_t before = elements.size();
    for (std::size_t column = 1;; ++column) {
      const FmuVariable* const one = model_.Find(fmt::format("{}[{},{}]", name, row, column));
      if (!of_causality(one) || !one->dimensions.empty()) break;
      elements.push_back({one, 0});
    }
    if (elements.size() == before) return elements;
  }
}

std::vector<std::string_view> FmuVariables::Names(FmuCausality causality) const {
  std::vector<std::string_view> names;
  for (const FmuVariable& variable : model_.variables)
    if (variable.causality == causality) names.push_back(variable.name);
  return names;
}

std::string QuotedNames(std::span<const std::string_view> names) {
  constexpr std::size_t kMost = 20;
  std::string text;
  for (std::size_t k = 0; k < names.size() && k < kMost; ++k)
    text += (k > 0 ? ", '" : "'") + Shortened(PlainLine(names[k]), 100) + "'";
  if (names.size() > kMost) text += fmt::format(" and {} more", names.size() - kMost);
  return text.empty() ? "none" : text;
}

std::string Suggestion(std::string_view word, std::span<const std::string_view> names) {
  const auto nearest = DidYouMean(word, names);
  return nearest ? " (did you mean \"" + PlainLine(*nearest) + "\"?)" : "";
}

void MapFmuSignals(const ModelDescription& model, std::size_t places, const std::string& file, Section& law,
                   FmuLawParams& params) {
  Mapper mapper(model, places, file, law, params);
  mapper.MapInputs();
  mapper.MapOutputs();
  mapper.Done();
}

}  // namespace mascot
