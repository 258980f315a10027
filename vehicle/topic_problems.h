#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mascot {

/// What is wrong with the newest sample of each of a vehicle's topics, in words for people.
class TopicProblems {
 public:
  /// `topics`: what is wrong with an earlier one is more important.
  explicit TopicProblems(std::vector<std::string_view> topics) {
    for (const std::string_view topic : topics) words_.emplace_back(topic, "");
  }
  /// Empty `words`: nothing is wrong any more.
  void Set(std::string_view topic, std::string words) {
    std::ranges::find(words_, topic, &std::pair<std::string_view, std::string>::first)->second = std::move(words);
  }
  /// What is wrong with the most important topic of those with which something is; empty: nothing is wrong with any.
  std::string First() const {
    const auto wrong = std::ranges::find_if(words_, [](const auto& each) { return !each.second.empty(); });
    return wrong == words_.end() ? "" : wrong->second;
  }

 private:
  std::vector<std::pair<std::string_view, std::string>> words_;
};

}  // namespace mascot
