#include "orchestrator/live/server/steering.h"

#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <cstdint>
#include <stdexcept>

namespace mascot {
namespace {

std::string NewToken() {
  std::uint8_t bytes[16];
  if (::getrandom(bytes, sizeof bytes, 0) != sizeof bytes) throw std::runtime_error("the system has no random numbers");
  std::string token;
  for (const std::uint8_t byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

/// In a time that says nothing of where they differ.
bool AreEqual(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  int differ = 0;
  for (std::size_t i = 0; i < a.size(); ++i) differ |= a[i] ^ b[i];
  return differ == 0;
}

}  // namespace

Steering::Steering(By by) : token_(by == By::kAll ? "" : NewToken()) {}

bool Steering::IsGranted(std::string_view target) const {
  if (token_.empty()) return true;
  constexpr std::string_view kName = "steer=";
  const std::size_t begin = target.find('?');
  std::string_view query = begin == target.npos ? "" : target.substr(begin + 1);
  while (!query.empty()) {
    const std::string_view field = query.substr(0, query.find('&'));
    if (field.starts_with(kName) && AreEqual(field.substr(kName.size()), token_)) return true;
    query.remove_prefix(std::min(query.size(), field.size() + 1));
  }
  return false;
}

}  // namespace mascot
