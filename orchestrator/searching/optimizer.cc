#include "orchestrator/searching/optimizer.h"

#include <chrono>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "base/number.h"
#include "orchestrator/formats/bytes.h"
#include "orchestrator/formats/output_file.h"
#include "orchestrator/formats/outside_json.h"
#include "orchestrator/sweeping/sweep_checks.h"
#include "system/script.h"
#include "system/spawn.h"

namespace mascot {
namespace {

using Json = nlohmann::json;

constexpr std::chrono::milliseconds kLook{1};  // between two looks for an answer

Json ToJson(const SearchedKey& key) {
  if (!key.choices.empty()) return {{"choices", key.choices}};
  return {{"min", key.range.min}, {"max", key.range.max}, {"log", key.range.log}};
}

/// The value of a key as the optimizer has it: a number, or one of the choices.
Json ToJson(const SearchedKey& key, const std::string& value) {
  return key.choices.empty() ? Json(NumberFrom<double>(value).value()) : Json(value);
}

std::string ValueFrom(const SearchedKey& key, const Json& value) {
  return key.choices.empty() ? ShortestFloat(value.get<double>()) : value.get<std::string>();
}

}  // namespace

Optimizer::Optimizer(const std::vector<SearchedKey>& keys, const Setting& setting, StopSignal& stop)
    : keys_(keys), stop_(stop) {
  Pipe to = MakePipe(), from = MakePipe();
  process_ = Spawn({.words = ScriptWords("optimizer.py"),
                    .group = Program::Group::kOwn,
                    .input = to.reads.number(),
                    .output = from.writes.number()});
  input_ = std::move(to.writes);
  output_ = std::move(from.reads);
  lines_ = std::make_unique<LineReader>(output_.number());
  Json described = {
      {"seed", setting.seed}, {"maximize", setting.maximize}, {"keys", Json::array()}, {"first", nullptr}};
  for (const SearchedKey& key : keys_) described["keys"].push_back(ToJson(key));
  if (setting.first)
    for (std::size_t k = 0; k < keys_.size(); ++k) described["first"].push_back(ToJson(keys_[k], (*setting.first)[k]));
  name_ = Answer(described).get<std::string>();
}

std::vector<Candidate> Optimizer::Ask(std::size_t count) {
  std::vector<Candidate> candidates;
  for (const Json& values : Answer({{"ask", count}})) {
    Candidate& candidate = candidates.emplace_back();
    for (std::size_t k = 0; k < keys_.size(); ++k) candidate.push_back(ValueFrom(keys_[k], values.at(k)));
  }
  return candidates;
}

void Optimizer::Tell(std::span<const std::optional<double>> values) {
  Json told = Json::array();
  for (const std::optional<double>& value : values) told.push_back(value ? Json(*value) : Json());
  Answer({{"tell", told}});
}

nlohmann::json Optimizer::Answer(const nlohmann::json& said) {
  const bool written = WriteFully(input_.number(), AsBytes(said.dump() + "\n"));
  while (written && !lines_->ended()) {
    if (const auto line = lines_->Next()) return ReadJson<Json>(*line);
    if (const int signal = stop_.Within(kLook); signal != 0) throw Interrupted{signal};
  }
  throw std::runtime_error("the optimiser " + EndText(process_.Reap().value_or(kUnknownEnd)));
}

}  // namespace mascot
