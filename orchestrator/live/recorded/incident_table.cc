#include "orchestrator/live/recorded/incident_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>

#include "base/number.h"
#include "base/utf8.h"
#include "orchestrator/formats/csv.h"
#include "orchestrator/measuring/incident_meter.h"

namespace mascot {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{1} << 28;  // of a table: what is beyond is left out

/// At most so many bytes of the table beside the recording; empty: there is none.
std::string TableBeside(const std::string& recording, std::size_t most) {
  const std::filesystem::path path = std::filesystem::path(recording).replace_filename("events.csv");
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return "";
  std::string text(std::min<std::size_t>(most, std::filesystem::file_size(path, error)), '\0');
  if (error) return "";
  std::ifstream table(path, std::ios::binary);
  table.read(text.data(), std::ssize(text));
  text.resize(static_cast<std::size_t>(table.gcount()));
  return text;
}

}  // namespace

std::string FirstIncidentsBeside(const std::string& recording) {
  constexpr std::size_t kMost = 1 << 17;  // bytes
  std::string text = TableBeside(recording, kMost);
  if (text.size() == kMost) text.resize(WholeCsvRows(text).size());
  return Plain(text);
}

void MarkManualEvents(const std::string& recording, const Experiment& experiment, std::vector<ShownEvent>& events) {
  constexpr std::string_view kEvent = "event ", kByHand = " by hand";
  const std::string table = TableBeside(recording, kMaxBytes);
  for (std::string_view text = table; !text.empty();) {
    const std::vector<std::string> fields = TakeCsvRow(text);  // t_s, until_s, what, count, agent, with, detail
    if (fields.size() != 7 || fields[2] != "event") continue;
    std::string_view with = fields[5];
    if (!with.starts_with(kEvent)) continue;
    const bool by_hand = with.ends_with(kByHand);
    if (by_hand) with.remove_suffix(kByHand.size());
    const auto number = NumberFrom<std::int64_t>(with.substr(kEvent.size()));
    if (!number) continue;
    const auto event = std::ranges::lower_bound(events, *number, {}, &ShownEvent::number);
    if (event == events.end() || event->number != *number) continue;
    if (fields[0] == fmt::format("{}", experiment.time_s(event->tick)) &&
        EventInTable(fields[6]) == EventInTable(event->toml))
      event->by_hand = by_hand;
  }
}

}  // namespace mascot
