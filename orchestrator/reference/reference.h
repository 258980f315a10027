#pragma once

#include <string>

namespace mascot {

/// Text of docs/configuration.md: every table and key of an experiment file, from the key tables that the reader uses.
std::string ConfigurationReference();  // reference.cc
/// Text of docs/mascot.schema.json: the same as a JSON Schema (draft 7), for editors.
std::string ConfigurationSchema();  // schema.cc

}  // namespace mascot
