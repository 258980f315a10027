#include "idl/schemas.h"

#include <algorithm>
#include <stdexcept>

namespace mascot {
namespace {

constexpr TypeSchema kSchemas[] = {
#include "schemas.inc"  // made from idl/**/*.msg by idl/make_schemas.py
};

}  // namespace

std::span<const TypeSchema> Schemas() { return kSchemas; }

const TypeSchema& SchemaOf(std::string_view name) {
  const auto* row =
      std::find_if(std::begin(kSchemas), std::end(kSchemas), [&](const auto& s) { return s.name == name; });
  if (row == std::end(kSchemas)) throw std::out_of_range("no schema for the type " + std::string(name));
  return *row;
}

const TypeSchema& SchemaOf(TopicKind kind) { return SchemaOf(TraitsOf(kind).type); }

std::string OfferedQos(const TopicTraits& topic) {
  // Keep last, reliable, transient local (1) or volatile (2), automatic liveliness; rmw writes an infinite duration as
  // this number of seconds.
  constexpr std::string_view kInfinite = "{sec: 9223372036, nsec: 854775807}\n";
  std::string yaml = "- history: 1\n  depth: " + std::to_string(topic.writer_depth);
  yaml.append("\n  reliability: 1\n  durability: ").append(topic.for_late_joiners ? "1\n" : "2\n");
  yaml.append("  deadline: ").append(kInfinite).append("  lifespan: ").append(kInfinite);
  yaml.append("  liveliness: 1\n  liveliness_lease_duration: ").append(kInfinite);
  return yaml + "  avoid_ros_namespace_conventions: false\n";
}

}  // namespace mascot
