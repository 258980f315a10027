#pragma once

#include <string>

namespace mascot {

/// docs/configuration.md: every table and key of an experiment file, from the rows that its readers read by.
std::string ConfigurationReference();  // reference.cc
/// docs/mascot.schema.json: the same as a JSON Schema (draft 7), for editors.
std::string ConfigurationSchema();  // schema.cc

}  // namespace mascot
