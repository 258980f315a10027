#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "experiment/toml/section.h"

namespace mascot {

/// Reads the document with these overrides, and returns its mistakes.
using MistakesWith = std::function<std::vector<std::string>(std::span<const Override> overrides)>;

/// The mistakes of the document `name` that was read with `overrides`, where those that stand at a place of the
/// document, but are not there without the overrides, say which of these made them: "--set law.name=minmax: law.beta:
/// expected a number in (0, 1000], got nothing (a.toml:4:7)". The document is read again, once without all overrides
/// and, if that is not enough, without each of them.
std::vector<std::string> BlameOverrides(const std::vector<std::string>& mistakes, const std::string& name,
                                        std::span<const Override> overrides, const MistakesWith& mistakes_with);

}  // namespace mascot
