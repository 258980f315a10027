#pragma once

#include "agent/laws.h"

namespace mascot {

inline constexpr Key kPluginParameters[] = {
    key::Text("library", "the shared library that holds the law; its path from the folder of this file").Required(),
    key::Any("params", "goes to the law's constructor, which refuses what it does not know").Default("{}").Live(),
    key::Boolean("messages", "whether it sends messages").Otherwise("whether it overrides Message()"),
    key::Integer("leader", 0, kMaxAgents, "for the law, if it asks; 0: none").Default("0"),
};

}  // namespace mascot
