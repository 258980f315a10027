#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/utf8.h"
#include "orchestrator/formats/mcap/reader.h"
#include "orchestrator/recording/completeness.h"
#include "orchestrator/recording/recording.h"
#include "orchestrator/report/json.h"
#include "orchestrator/verbs/verb.h"

namespace mascot {
namespace {

using ChannelInfo = McapContents::ChannelInfo;
/// Contents of a recording, and whether it is complete.
struct Findings {
  std::string file;
  std::uint64_t size_bytes = 0;
  McapContents contents;
  Verdict verdict;

  bool complete() const { return verdict.reason.empty(); }
  /// The rows of a complete recording.
  std::optional<std::int64_t> rows() const {
    if (!verdict.ticks) return std::nullopt;
    return RecordedTicks(static_cast<std::int64_t>(*verdict.ticks), verdict.plan->ticks_per_row).rows();
  }
  std::optional<std::uint64_t> planned_ticks() const {
    return verdict.plan ? std::optional(verdict.plan->ticks) : std::nullopt;
  }
};

double Seconds(std::uint64_t ns) { return static_cast<double>(ns) * 1e-9; }

double Hz(const ChannelInfo& channel) {
  const double span_s = Seconds(channel.last_time - channel.first_time);
  return channel.messages > 1 && span_s > 0 ? static_cast<double>(channel.messages - 1) / span_s : 0;
}

double Ratio(const McapContents& contents) {
  if (contents.compressed_bytes == 0) return 1;
  return static_cast<double>(contents.uncompressed_bytes) / static_cast<double>(contents.compressed_bytes);
}

double DurationSeconds(const McapContents& contents) {
  std::optional<std::uint64_t> first, last;
  for (const auto& [id, channel] : contents.channels) {
    if (channel.messages == 0) continue;
    first = std::min(first.value_or(channel.first_time), channel.first_time);
    last = std::max(last.value_or(channel.last_time), channel.last_time);
  }
  return first ? Seconds(*last - *first) : 0;
}

Findings Inspect(const std::string& run) {
  Findings findings;
  findings.file = FindRecording(run);
  findings.contents = ReadMcap(findings.file);
  findings.size_bytes = std::filesystem::file_size(findings.file);
  findings.verdict = Judge(findings.file, findings.contents);
  return findings;
}

Json ToJson(const Findings& findings) {
  const McapContents& contents = findings.contents;
  Json topics = Json::array();
  for (const auto& [id, channel] : contents.channels)
    topics.push_back({{"topic", channel.topic},
                      {"type", channel.schema_name},
                      {"count", channel.messages},
                      {"hz", Hz(channel)},
                      {"bytes", channel.bytes},
                      {"gaps", channel.gaps},
                      {"first_ns", channel.first_time},
                      {"last_ns", channel.last_time}});
  Json attachments = Json::array();
  for (const auto& [name, data] : contents.attachments) attachments.push_back({{"name", name}, {"bytes", data.size()}});
  return {{"file", findings.file},
          {"size_bytes", findings.size_bytes},
          {"profile", contents.profile},
          {"library", contents.library},
          {"duration_s", DurationSeconds(contents)},
          {"messages", contents.messages},
          {"chunks", contents.chunks},
          {"compressed_bytes", contents.compressed_bytes},
          {"uncompressed_bytes", contents.uncompressed_bytes},
          {"compression_ratio", Ratio(contents)},
          {"topics", topics},
          {"attachments", attachments},
          {"metadata", contents.metadata},
          {"ticks", OrNull(findings.verdict.ticks)},
          {"rows", OrNull(findings.rows())},
          {"planned_ticks", OrNull(findings.planned_ticks())},
          {"complete", findings.complete()},
          {"reason", findings.verdict.reason}};
}

void PrintTopics(const McapContents& contents) {
  std::size_t topic_width = 5, type_width = 4;
  for (const auto& [id, channel] : contents.channels) {
    topic_width = std::max(topic_width, PlainLine(channel.topic).size());
    type_width = std::max(type_width, PlainLine(channel.schema_name).size());
  }
  std::cout << fmt::format("  {:<{}}  {:<{}}{:>12}{:>12}\n", "topic", topic_width, "type", type_width, "count", "Hz");
  for (const auto& [id, channel] : contents.channels)
    std::cout << fmt::format("  {:<{}}  {:<{}}{:>12}{:>12.2f}\n", PlainLine(channel.topic), topic_width,
                             PlainLine(channel.schema_name), type_width, channel.messages, Hz(channel));
}

void PrintText(const Findings& findings) {
  const McapContents& contents = findings.contents;
  const auto print = [](std::string_view label, const std::string& text) {
    std::cout << fmt::format("{:<14}{}\n", label, PlainLine(text));
  };
  print("file:", findings.file);
  print("size:", fmt::format("{} bytes", findings.size_bytes));
  print("profile:", fmt::format("{} (written by {})", contents.profile, contents.library));
  print("duration:", fmt::format("{:.3f} s", DurationSeconds(contents)));
  print("messages:", fmt::format("{}", contents.messages));
  print("chunks:", fmt::format("{}", contents.chunks));
  print("compression:", fmt::format("{:.3f} to 1", Ratio(contents)));
  std::cout << "\n";
  PrintTopics(contents);
  std::cout << "\n";
  for (const auto& [name, data] : contents.attachments)
    print("attachment:", fmt::format("{}, {} bytes", name, data.size()));
  for (const auto& [name, entries] : contents.metadata) {
    print("metadata:", name);
    for (const auto& [key, value] : entries) print("", fmt::format("{} = {}", key, value));
  }
  if (const auto ticks = findings.verdict.ticks) {
    const std::uint64_t planned = findings.verdict.plan->ticks;
    const bool is_sparse = findings.verdict.plan->ticks_per_row > 1;
    print("ticks:", fmt::format("{}{}{}, recorded without a gap", *ticks,
                                *ticks < planned ? fmt::format(" of {}: the run ended early", planned) : "",
                                is_sparse ? fmt::format(", of which {} have a row", *findings.rows()) : ""));
  }
  std::cout << "complete: " << (findings.complete() ? "yes" : "no (" + PlainLine(findings.verdict.reason) + ")")
            << "\n";
}

int Info(const std::string& run, bool as_json) {
  Findings findings;
  try {
    findings = Inspect(run);
  } catch (const std::exception& error) {  // no such file, no permission, not a recording
    std::cerr << "error: " << error.what() << "\n";
    return 2;
  }
  if (as_json)
    std::cout << JsonText(ToJson(findings)) << std::flush;
  else
    PrintText(findings);
  return findings.complete() ? 0 : 1;
}

}  // namespace

std::function<int()> SetUpInfo(CLI::App& command) {
  struct Options {
    std::string run;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  command
      .add_option("run", options->run, "a run folder, a folder of runs or 'latest' for the newest, or an .mcap file")
      ->required()
      ->type_name("RUN");
  command.add_flag("--json", options->json, "print one JSON object and nothing else");
  return [options] { return Info(options->run, options->json); };
}

}  // namespace mascot
