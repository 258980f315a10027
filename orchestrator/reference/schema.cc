#include <algorithm>
#include <string_view>

#include "agent/laws/laws.h"
#include "experiment/experiment.h"
#include "experiment/toml/key.h"
#include "orchestrator/reference/reference.h"
#include "orchestrator/report/json.h"

namespace mascot {
namespace {

Json SchemaOf(const Key& key);

Json NumberSchema(const Range& range) {
  return {{"type", "number"}, {range.open_min ? "exclusiveMinimum" : "minimum", range.min}, {"maximum", range.max}};
}

Json ListOf(Json item) { return {{"type", "array"}, {"items", std::move(item)}}; }

Json VectorSchema(const Range& range) {
  Json schema = ListOf(NumberSchema(range));
  schema["minItems"] = schema["maxItems"] = 3;
  return schema;
}

Json TableSchema(std::span<const Key> rows) {
  Json properties = Json::object(), required = Json::array();
  for (const Key& key : rows) {
    properties[key.name] = SchemaOf(key);
    if (key.required) required.push_back(key.name);
  }
  Json schema = {{"type", "object"}, {"additionalProperties", false}, {"properties", std::move(properties)}};
  if (!required.empty()) schema["required"] = std::move(required);
  return schema;
}

Json ValueSchema(ValueKind kind, const Key& key) {
  switch (kind) {
    case ValueKind::kNumber:
      return NumberSchema(key.range);
    case ValueKind::kInteger:
      return {{"type", "integer"}, {"minimum", key.min_integer}, {"maximum", key.max_integer}};
    case ValueKind::kBoolean:
      return {{"type", "boolean"}};
    case ValueKind::kOneOf:
      return {{"type", "string"}, {"enum", std::vector<std::string_view>(key.names.begin(), key.names.end())}};
    case ValueKind::kTexts:
      return ListOf({{"type", "string"}});
    case ValueKind::kVector3:
      return VectorSchema(key.range);
    case ValueKind::kNumbers:
      return ListOf(NumberSchema(key.range));
    case ValueKind::kRows:
      return ListOf(ListOf(NumberSchema(key.range)));
    case ValueKind::kPoints:
      return ListOf(VectorSchema(key.range));
    case ValueKind::kPointLists:
      return ListOf(ListOf(VectorSchema(key.range)));
    case ValueKind::kTable:
      return TableSchema(key.keys);
    case ValueKind::kTables:
      return ListOf(TableSchema(key.keys));
    case ValueKind::kAny:
      return {{"type", "object"}};
    case ValueKind::kText:
    case ValueKind::kNone:
      break;
  }
  return {{"type", "string"}};
}

Json SchemaOf(const Key& key) {
  Json schema = ValueSchema(key.kind, key);
  if (key.or_kind != ValueKind::kNone)
    schema = {{"anyOf", Json::array({std::move(schema), ValueSchema(key.or_kind, key)})}};
  std::string description(key.meaning);
  if (!key.unit.empty()) description.append(" (").append(key.unit).append(")");
  if (!key.otherwise.empty()) description.append("; without it: ").append(key.otherwise);
  if (key.live) description.append("; live: an event may change it");
  if (!description.empty()) schema["description"] = description;
  if (!key.fallback.empty()) schema["default"] = DefaultJson(key);
  return schema;
}

/// Refers to the schema of the parameters of a law, in `definitions`.
Json ParametersOf(const LawEntry& law) { return {{"$ref", "#/definitions/parameters_of_" + std::string(law.name)}}; }

/// Schema (if/then) of a table of `rows` and the parameters of one law. `inherits`: keys that are left out, `name` too,
/// may be set in another table.
Json LawCase(const LawEntry& law, std::span<const Key> rows, bool inherits) {
  Json schema = TableSchema(law.parameters);
  Json names = Json::array();
  for (const Key& key : rows) names.push_back(key.name);
  for (const Key& key : law.parameters)
    if (std::ranges::find(names, Json(key.name)) == names.end()) names.push_back(key.name);
  Json then = {{"propertyNames", {{"enum", std::move(names)}}}, {"allOf", Json::array({ParametersOf(law)})}};
  if (!inherits && schema.contains("required")) then["required"] = std::move(schema["required"]);
  Json condition = {{"properties", {{"name", {{"const", law.name}}}}}};
  if (inherits || law.name != LawNames().front()) condition["required"] = Json::array({"name"});
  return {{"if", std::move(condition)}, {"then", std::move(then)}};
}

/// Schema of a law table, whose common keys are `rows`: every key of any law, and one if/then case per law.
Json LawSchema(std::span<const Key> rows, bool inherits) {
  Json schema = TableSchema(rows);
  Json& properties = schema["properties"];
  properties["name"]["enum"] = std::vector<std::string_view>(LawNames().begin(), LawNames().end());
  if (!inherits) properties["name"]["default"] = LawNames().front();
  Json cases = Json::array();
  for (const LawEntry& law : Laws()) {
    for (const Key& key : law.parameters)
      if (!properties.contains(key.name)) properties[key.name] = Json::object();  // the case of its law has the schema
    cases.push_back(LawCase(law, rows, inherits));
  }
  schema["allOf"] = std::move(cases);
  return schema;
}

/// Schema of [law] or of an agent's own law table. The phases of its schedule are in `definitions`.
Json LawTableSchema(bool inherits) {
  Json schema = LawSchema(LawKeys(), inherits);
  schema["properties"]["schedule"]["items"] = {{"$ref", "#/definitions/law_phase"}};
  return schema;
}

}  // namespace

std::string ConfigurationSchema() {
  Json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", "MASCOT experiment"}};
  schema.update(TableSchema(ExperimentKeys()));
  schema["required"] = Json::array({"run", "agents"});  // both have a required key
  Json& tables = schema["properties"];
  tables["law"].update(LawTableSchema(false));
  tables["agents"]["properties"]["override"]["items"]["properties"]["law"].update(LawTableSchema(true));
  const Key& schedule = *std::ranges::find(LawKeys(), "schedule", &Key::name);
  schema["definitions"]["law_phase"] = LawSchema(schedule.keys, true);
  for (const LawEntry& law : Laws())
    schema["definitions"]["parameters_of_" + std::string(law.name)] = {
        {"properties", TableSchema(law.parameters)["properties"]}};
  return JsonText(schema);
}

}  // namespace mascot
