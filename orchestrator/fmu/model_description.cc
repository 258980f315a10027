#include "orchestrator/fmu/model_description.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "orchestrator/fmu/units.h"

namespace mascot {
namespace {

using Causality = FmuVariable::Causality;

constexpr std::string_view kHead = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";

/// Text as the value of an attribute in XML. Control characters, which XML does not have, become spaces.
std::string Escaped(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&')
      escaped += "&amp;";
    else if (c == '<')
      escaped += "&lt;";
    else if (c == '>')
      escaped += "&gt;";
    else if (c == '"')
      escaped += "&quot;";
    else
      escaped += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return escaped;
}

std::string Attribute(std::string_view name, std::string_view value) {
  return fmt::format(" {}=\"{}\"", name, Escaped(value));
}

std::string_view NameOf(Causality causality) {
  constexpr std::array kNames = {"independent", "parameter", "input", "output"};
  return kNames.at(static_cast<std::size_t>(causality));
}

/// Inputs are taken at communication points, whatever signal they are of. Outputs change at ticks alone.
std::string_view VariabilityOf(const FmuVariable& variable) {
  const bool is_real = std::holds_alternative<double>(variable.start);
  if (variable.causality == Causality::kParameter) return variable.tunable ? "tunable" : "fixed";
  return is_real && variable.causality != Causality::kOutput ? "continuous" : "discrete";
}

bool HasStart(const FmuVariable& variable) {
  return variable.causality == Causality::kParameter || variable.causality == Causality::kInput;
}

std::string StartText(const FmuVariable& variable) {
  if (const auto* number = std::get_if<double>(&variable.start)) return fmt::format("{}", *number);
  if (const auto* number = std::get_if<std::int64_t>(&variable.start)) return fmt::format("{}", *number);
  if (const auto* truth = std::get_if<bool>(&variable.start)) return *truth ? "true" : "false";
  return std::get<std::string>(variable.start);
}

/// Name, description, causality, variability and initial, which both versions have.
std::string CommonAttributes(const FmuVariable& variable, std::size_t reference) {
  std::string text = Attribute("name", variable.name) + fmt::format(" valueReference=\"{}\"", reference) +
                     Attribute("description", variable.description) +
                     Attribute("causality", NameOf(variable.causality)) +
                     Attribute("variability", VariabilityOf(variable));
  if (variable.causality == Causality::kParameter) text += " initial=\"exact\"";
  if (variable.causality == Causality::kOutput) text += " initial=\"calculated\"";
  return text;
}

/// Unit and range of a double.
std::string RealAttributes(const FmuVariable& variable) {
  std::string text;
  if (!variable.unit.empty()) text += Attribute("unit", variable.unit);
  if (variable.range) text += fmt::format(" min=\"{}\" max=\"{}\"", variable.range->first, variable.range->second);
  return text;
}

std::string Variable2(const FmuVariable& variable, std::size_t reference) {
  constexpr std::array kTypes = {"Real", "Integer", "Boolean", "String"};
  std::string attributes = RealAttributes(variable);
  if (HasStart(variable)) attributes += Attribute("start", StartText(variable));
  return fmt::format("    <ScalarVariable{}><{}{}/></ScalarVariable>\n", CommonAttributes(variable, reference),
                     kTypes.at(variable.start.index()), attributes);
}

std::string Variable3(const FmuVariable& variable, std::size_t reference) {
  constexpr std::array kTypes = {"Float64", "Int64", "Boolean", "String"};
  const char* const type = kTypes.at(variable.start.index());
  std::string attributes = CommonAttributes(variable, reference) + RealAttributes(variable);
  if (!HasStart(variable)) return fmt::format("    <{}{}/>\n", type, attributes);
  if (std::holds_alternative<std::string>(variable.start))
    return fmt::format("    <{0}{1}><Start{2}/></{0}>\n", type, attributes, Attribute("value", StartText(variable)));
  return fmt::format("    <{}{}{}/>\n", type, attributes, Attribute("start", StartText(variable)));
}

std::string UnitDefinitions(const FmuTeam& team) {
  std::vector<std::string> units;
  for (const FmuVariable& variable : team.variables)
    if (!variable.unit.empty() && std::ranges::find(units, variable.unit) == units.end())
      units.push_back(variable.unit);
  std::string text = "  <UnitDefinitions>\n";
  for (const std::string& unit : units) {
    const auto base = BaseUnitOf(unit);
    constexpr std::array kBases = {"kg", "m", "s", "rad"};
    std::string attributes;
    for (std::size_t n = 0; base && n < kBases.size(); ++n)
      if (base->exponents[n] != 0) attributes += fmt::format(" {}=\"{}\"", kBases.at(n), base->exponents.at(n));
    if (base && base->factor != 1) attributes += fmt::format(" factor=\"{}\"", base->factor);
    text += base ? fmt::format("    <Unit{}><BaseUnit{}/></Unit>\n", Attribute("name", unit), attributes)
                 : fmt::format("    <Unit{}/>\n", Attribute("name", unit));
  }
  return text + "  </UnitDefinitions>\n";
}

/// What stands between the kind of the FMU and its variables in both versions.
std::string UpToVariables(const FmuTeam& team) {
  return UnitDefinitions(team) +
         "  <LogCategories>\n"
         "    <Category name=\"logStatusWarning\" description=\"warnings\"/>\n"
         "    <Category name=\"logStatusDiscard\" description=\"why a step was not made\"/>\n"
         "    <Category name=\"logStatusError\" description=\"errors, which are always told\"/>\n"
         "    <Category name=\"logStatusFatal\" description=\"errors after which nothing can go on, always told\"/>\n"
         "    <Category name=\"logAll\" description=\"all of them\"/>\n"
         "  </LogCategories>\n" +
         fmt::format("  <DefaultExperiment startTime=\"0\" stopTime=\"{}\" stepSize=\"{}\"/>\n", team.duration_s,
                     1.0 / team.rate_hz);
}

std::string CommonHead(const FmuTeam& team) {
  return Attribute("modelName", team.name) +
         Attribute("description", fmt::format("A team of {} agents, which a process of MASCOT flies", team.agents)) +
         Attribute("generationTool", "MASCOT " MASCOT_VERSION) + " variableNamingConvention=\"structured\"";
}

std::string Description2(const FmuTeam& team, const std::string& token) {
  std::string text(kHead);
  text += "<fmiModelDescription fmiVersion=\"2.0\"" + Attribute("guid", token) + CommonHead(team) + ">\n";
  text += "  <CoSimulation" + Attribute("modelIdentifier", team.identifier) +
          " needsExecutionTool=\"true\" canHandleVariableCommunicationStepSize=\"true\""
          " canNotUseMemoryManagementFunctions=\"true\" canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"true\">\n"
          "    <SourceFiles><File name=\"team_fmu.c\"/></SourceFiles>\n"
          "  </CoSimulation>\n";
  text += UpToVariables(team) + "  <ModelVariables>\n";
  std::string outputs, unknowns;
  for (std::size_t k = 0; k < team.variables.size(); ++k) {
    text += Variable2(team.variables[k], k);
    if (team.variables[k].causality != Causality::kOutput) continue;
    outputs += fmt::format("      <Unknown index=\"{}\" dependencies=\"\"/>\n", k + 1);
    unknowns += fmt::format("      <Unknown index=\"{}\"/>\n", k + 1);
  }
  return text + "  </ModelVariables>\n  <ModelStructure>\n    <Outputs>\n" + outputs +
         "    </Outputs>\n    <InitialUnknowns>\n" + unknowns +
         "    </InitialUnknowns>\n  </ModelStructure>\n</fmiModelDescription>\n";
}

std::string Description3(const FmuTeam& team, const std::string& token) {
  std::string text(kHead);
  text += "<fmiModelDescription fmiVersion=\"3.0\"" + Attribute("instantiationToken", token) + CommonHead(team) + ">\n";
  text += "  <CoSimulation" + Attribute("modelIdentifier", team.identifier) +
          " needsExecutionTool=\"true\" canHandleVariableCommunicationStepSize=\"true\"" +
          fmt::format(" fixedInternalStepSize=\"{}\"", 1.0 / team.rate_hz) +
          " canGetAndSetFMUState=\"true\" canSerializeFMUState=\"true\"/>\n";
  text += UpToVariables(team) + "  <ModelVariables>\n";
  std::string outputs, unknowns;
  for (std::size_t k = 0; k < team.variables.size(); ++k) {
    text += Variable3(team.variables[k], k);
    if (team.variables[k].causality != Causality::kOutput) continue;
    outputs += fmt::format("    <Output valueReference=\"{}\" dependencies=\"\"/>\n", k);
    unknowns += fmt::format("    <InitialUnknown valueReference=\"{}\"/>\n", k);
  }
  return text + "  </ModelVariables>\n  <ModelStructure>\n" + outputs + unknowns +
         "  </ModelStructure>\n</fmiModelDescription>\n";
}

}  // namespace

std::string ModelDescription(FmiVersion version, const FmuTeam& team, const std::string& token) {
  return version == FmiVersion::k2 ? Description2(team, token) : Description3(team, token);
}

std::string BuildDescription(const FmuTeam& team, const std::string& source) {
  const std::string identifier = Attribute("modelIdentifier", team.identifier);
  const std::string files =
      "    <SourceFileSet language=\"C99\"><SourceFile" + Attribute("name", source) + "/></SourceFileSet>\n";
  std::string text = std::string(kHead) + "<fmiBuildDescription fmiVersion=\"3.0\">\n";
  text += "  <BuildConfiguration" + identifier + ">\n" + files + "  </BuildConfiguration>\n";
  for (const char* platform : {"x86_64-windows", "x86-windows", "aarch64-windows"})
    text += "  <BuildConfiguration" + identifier + Attribute("platform", platform) + ">\n" + files +
            "    <Library name=\"ws2_32\" external=\"true\" description=\"sockets of Windows\"/>\n"
            "  </BuildConfiguration>\n";
  return text + "</fmiBuildDescription>\n";
}

}  // namespace mascot
