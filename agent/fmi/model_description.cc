#include "agent/fmi/model_description.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "agent/fmi/error.h"
#include "base/number.h"
#include "base/utf8.h"

namespace mascot {
namespace {

using tinyxml2::XMLElement;

std::string Quoted(std::string_view text) { return "'" + Shortened(PlainLine(text), 100) + "'"; }

std::string Attribute(const XMLElement& element, const char* name) {
  const char* const value = element.Attribute(name);
  return value != nullptr ? value : "";
}

std::string NameOf(const XMLElement& element) { return Attribute(element, "name"); }

/// Booleans of XML Schema.
bool IsTrue(const XMLElement& element, const char* name) {
  const std::string value = Attribute(element, name);
  return value == "true" || value == "1";
}

std::optional<double> PositiveNumber(const XMLElement& element, const char* name) {
  const auto number = NumberFrom<double>(Attribute(element, name));
  return number && std::isfinite(*number) && *number > 0 ? number : std::nullopt;
}

std::uint32_t Reference(const XMLElement& element) {
  const auto reference = NumberFrom<std::uint32_t>(Attribute(element, "valueReference"));
  if (!reference)
    throw FmuError(fmt::format("modelDescription.xml:{}: expected a number as valueReference of variable {}, got {}",
                               element.GetLineNum(), Quoted(NameOf(element)),
                               Quoted(Attribute(element, "valueReference"))));
  return *reference;
}

FmuCausality CausalityOf(const XMLElement& element) {
  const std::string name = Attribute(element, "causality");
  if (name == "input") return FmuCausality::kInput;
  if (name == "output") return FmuCausality::kOutput;
  if (name == "parameter") return FmuCausality::kParameter;
  if (name == "structuralParameter") return FmuCausality::kStructuralParameter;
  return FmuCausality::kOther;
}

FmuVariability VariabilityOf(const XMLElement& element) {
  const std::string name = Attribute(element, "variability");
  if (name == "fixed") return FmuVariability::kFixed;
  if (name == "tunable") return FmuVariability::kTunable;
  return FmuVariability::kOther;
}

struct TypeName {
  std::string_view name;
  FmuType type;
};
constexpr TypeName kTypesOfFmi2[] = {{"Real", FmuType::kFloat64},
                                     {"Integer", FmuType::kInt32},
                                     {"Enumeration", FmuType::kInt32},
                                     {"Boolean", FmuType::kBoolean},
                                     {"String", FmuType::kString}};
constexpr TypeName kTypesOfFmi3[] = {
    {"Float64", FmuType::kFloat64},   {"Float32", FmuType::kFloat32}, {"Int8", FmuType::kInt8},
    {"UInt8", FmuType::kUInt8},       {"Int16", FmuType::kInt16},     {"UInt16", FmuType::kUInt16},
    {"Int32", FmuType::kInt32},       {"UInt32", FmuType::kUInt32},   {"Int64", FmuType::kInt64},
    {"UInt64", FmuType::kUInt64},     {"Boolean", FmuType::kBoolean}, {"String", FmuType::kString},
    {"Enumeration", FmuType::kInt64}, {"Binary", FmuType::kOther},    {"Clock", FmuType::kOther}};

template <std::size_t n>
std::optional<FmuType> TypeOf(const TypeName (&types)[n], std::string_view name) {
  const auto* const found = std::find_if(types, types + n, [&](const TypeName& type) { return type.name == name; });
  return found != types + n ? std::optional(found->type) : std::nullopt;
}

FmuVariable Common(const XMLElement& element) {
  FmuVariable variable;
  variable.name = NameOf(element);
  if (variable.name.empty())
    throw FmuError(fmt::format("modelDescription.xml:{}: a variable without a name", element.GetLineNum()));
  variable.reference = Reference(element);
  variable.causality = CausalityOf(element);
  variable.variability = VariabilityOf(element);
  return variable;
}

std::vector<FmuVariable> VariablesOfFmi2(const XMLElement& list) {
  std::vector<FmuVariable> variables;
  for (const XMLElement* one = list.FirstChildElement("ScalarVariable"); one != nullptr;
       one = one->NextSiblingElement("ScalarVariable")) {
    FmuVariable variable = Common(*one);
    for (const XMLElement* child = one->FirstChildElement(); child != nullptr; child = child->NextSiblingElement())
      if (const auto type = TypeOf(kTypesOfFmi2, child->Name())) {
        variable.type = *type;
        variable.has_start = child->Attribute("start") != nullptr;
      }
    variables.push_back(std::move(variable));
  }
  return variables;
}

/// The extents of an array; those that are structural parameters are 1 for now.
std::vector<FmuDimension> Dimensions(const XMLElement& element) {
  std::vector<FmuDimension> dimensions;
  for (const XMLElement* one = element.FirstChildElement("Dimension"); one != nullptr;
       one = one->NextSiblingElement("Dimension")) {
    FmuDimension dimension;
    if (one->Attribute("valueReference") != nullptr) {
      dimension.parameter = NumberFrom<std::uint32_t>(Attribute(*one, "valueReference"));
    } else if (const auto size = NumberFrom<std::size_t>(Attribute(*one, "start"));
               size && *size <= ModelDescription::kMaxArray) {
      dimension.size = *size;
    } else {
      throw FmuError(fmt::format("modelDescription.xml:{}: expected a dimension of at most {}, got {}",
                                 one->GetLineNum(), ModelDescription::kMaxArray, Quoted(Attribute(*one, "start"))));
    }
    dimensions.push_back(dimension);
  }
  return dimensions;
}

/// Gives dimensions that are structural parameters these parameters' start values, which are by value reference.
void ResolveDimensions(std::vector<FmuVariable>& variables, const std::map<std::uint32_t, std::size_t>& starts) {
  for (FmuVariable& variable : variables) {
    std::size_t size = 1;
    for (FmuDimension& dimension : variable.dimensions) {
      if (dimension.parameter) {
        const auto start = starts.find(*dimension.parameter);
        if (start == starts.end())
          throw FmuError("a dimension of variable " + Quoted(variable.name) +
                         " is a structural parameter that has no start value");
        dimension.size = start->second;
      }
      if (dimension.size > 0 && size > ModelDescription::kMaxArray / dimension.size)
        throw FmuError(
            fmt::format("variable {} has more than {} values", Quoted(variable.name), ModelDescription::kMaxArray));
      size *= dimension.size;
    }
  }
}

std::vector<FmuVariable> VariablesOfFmi3(const XMLElement& list) {
  std::vector<FmuVariable> variables;
  std::map<std::uint32_t, std::size_t> starts;
  for (const XMLElement* one = list.FirstChildElement(); one != nullptr; one = one->NextSiblingElement()) {
    const auto type = TypeOf(kTypesOfFmi3, one->Name());
    if (!type) continue;
    FmuVariable variable = Common(*one);
    variable.type = *type;
    variable.has_start = one->Attribute("start") != nullptr || one->FirstChildElement("Start") != nullptr;
    variable.dimensions = Dimensions(*one);
    if (variable.causality == FmuCausality::kStructuralParameter)
      if (const auto start = NumberFrom<std::size_t>(Attribute(*one, "start")); start)
        starts.emplace(variable.reference, *start);
    for (const XMLElement* alias = one->FirstChildElement("Alias"); alias != nullptr;
         alias = alias->NextSiblingElement("Alias")) {
      FmuVariable other = variable;
      other.name = NameOf(*alias);
      if (!other.name.empty()) variables.push_back(std::move(other));
    }
    variables.push_back(std::move(variable));
  }
  ResolveDimensions(variables, starts);
  return variables;
}

int VersionOf(const XMLElement& root) {
  const std::string version = Attribute(root, "fmiVersion");
  if (version.starts_with("2.")) return 2;
  if (version.starts_with("3.")) return 3;
  throw FmuError("an FMU of FMI " + Quoted(version) + ", expected FMI 2 or 3");
}

const XMLElement& CoSimulationOf(const XMLElement& root) {
  if (const XMLElement* const found = root.FirstChildElement("CoSimulation"); found != nullptr) return *found;
  std::string others;
  for (const char* const kind : {"ModelExchange", "ScheduledExecution"})
    if (root.FirstChildElement(kind) != nullptr) others += std::string(others.empty() ? "" : " and ") + kind;
  throw FmuError("an FMU for " + (others.empty() ? "nothing" : others) + " alone, expected one for CoSimulation");
}

/// The categories for warnings and errors that the FMU has, of those that the standard names.
std::vector<std::string> ErrorCategories(const XMLElement& root) {
  constexpr std::string_view kStandard[] = {"logStatusWarning", "logStatusDiscard", "logStatusError", "logStatusFatal"};
  std::vector<std::string> categories;
  const XMLElement* const list = root.FirstChildElement("LogCategories");
  for (const XMLElement* one = list != nullptr ? list->FirstChildElement("Category") : nullptr; one != nullptr;
       one = one->NextSiblingElement("Category"))
    if (std::ranges::find(kStandard, NameOf(*one)) != std::end(kStandard)) categories.push_back(NameOf(*one));
  return categories;
}

bool IsNameInC(std::string_view name) {
  return !name.empty() && name.size() <= 200 && std::isdigit(static_cast<unsigned char>(name[0])) == 0 &&
         std::ranges::all_of(name, [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
}

void RequireEachNameOnce(const std::vector<FmuVariable>& variables) {
  std::set<std::string_view> names;
  for (const FmuVariable& variable : variables)
    if (!names.insert(variable.name).second)
      throw FmuError("modelDescription.xml has variable " + Quoted(variable.name) + " twice");
}

const XMLElement& RootOf(const tinyxml2::XMLDocument& document) {
  for (const tinyxml2::XMLNode* node = document.FirstChild(); node != nullptr; node = node->NextSibling())
    if (node->ToUnknown() != nullptr) throw FmuError("modelDescription.xml has a document type, which is not read");
  const XMLElement* const root = document.FirstChildElement("fmiModelDescription");
  if (root == nullptr) throw FmuError("modelDescription.xml without the element fmiModelDescription");
  return *root;
}

}  // namespace

std::size_t FmuVariable::size() const {
  std::size_t size = 1;
  for (const FmuDimension& dimension : dimensions) size *= dimension.size;
  return size;
}

const FmuVariable* ModelDescription::Find(std::string_view name) const {
  const auto found = std::ranges::find(variables, name, &FmuVariable::name);
  return found != variables.end() ? &*found : nullptr;
}

ModelDescription ModelDescription::FromXml(const std::string& text) {
  if (text.size() > kMaxBytes)
    throw FmuError(fmt::format("modelDescription.xml of {} bytes, expected at most {}", text.size(), kMaxBytes));
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
    throw FmuError(fmt::format("modelDescription.xml:{}: no XML: {}", document.ErrorLineNum(),
                               tinyxml2::XMLDocument::ErrorIDToName(document.ErrorID())));
  const XMLElement& root = RootOf(document);
  ModelDescription description;
  description.version = VersionOf(root);
  const XMLElement& kind = CoSimulationOf(root);
  description.model_identifier = Attribute(kind, "modelIdentifier");
  if (!IsNameInC(description.model_identifier))
    throw FmuError("modelDescription.xml: expected a name in C as modelIdentifier, got " +
                   Quoted(description.model_identifier));
  description.token = Attribute(root, description.version == 2 ? "guid" : "instantiationToken");
  description.once_per_process = IsTrue(kind, "canBeInstantiatedOnlyOncePerProcess");
  description.handles_variable_steps = IsTrue(kind, "canHandleVariableCommunicationStepSize");
  description.fixed_step_s = PositiveNumber(kind, "fixedInternalStepSize");
  if (const XMLElement* const experiment = root.FirstChildElement("DefaultExperiment");
      experiment != nullptr && !description.fixed_step_s)
    description.fixed_step_s = PositiveNumber(*experiment, "stepSize");
  description.error_categories = ErrorCategories(root);
  if (const XMLElement* const list = root.FirstChildElement("ModelVariables"); list != nullptr)
    description.variables = description.version == 2 ? VariablesOfFmi2(*list) : VariablesOfFmi3(*list);
  RequireEachNameOnce(description.variables);
  return description;
}

}  // namespace mascot
