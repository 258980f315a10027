#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "experiment/toml/section.h"
#include "orchestrator/formats/mcap/writer.h"
#include "orchestrator/recording/recording.h"
#include "orchestrator/report/json.h"
#include "orchestrator/verbs/verb.h"

namespace mascot {
namespace {

using ChannelInfo = McapContents::ChannelInfo;
/// What was found in one recording, and whether it is all there.
struct Findings {
  std::string file;
  std::uint64_t size_bytes = 0;
  McapContents contents;
  std::optional<std::uint64_t> ticks;          ///< if it is complete and has topics with a sample of every tick
  std::optional<std::uint64_t> planned_ticks;  ///< of the experiment, if that is attached
  std::string reason;                          ///< why it is not complete; empty if it is

  bool complete() const { return reason.empty(); }
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

struct Planned {
  bool realtime = false;
  std::optional<std::uint64_t> ticks;
};

/// What the attached experiment says; nothing if there is none, or somebody else's.
Planned PlanOf(const McapContents& contents) {
  const auto attached = contents.attachments.find("config.toml");
  if (attached == contents.attachments.end()) return {};
  try {
    Section config = Section::FromText(attached->second, attached->first);
    Section run = config.Child("run"), control = config.Child("control");
    Planned planned{.realtime = run.Text("mode", "lockstep") == "realtime", .ticks = {}};
    if (!run.Has("duration_s") || !control.Has("rate_hz")) return planned;
    const double duration_s = run.Number("duration_s", 0, 1e9);
    const auto rate_hz = static_cast<double>(control.Integer("rate_hz", 1, 1'000'000));
    planned.ticks = static_cast<std::uint64_t>(std::llround(duration_s * rate_hz)) + 1;
    return planned;
  } catch (const ConfigError&) {
    return {};
  }
}

/// Whether a channel holds a sample of every tick. In real time a late agent's last command is held, so that
/// commands may be fewer.
bool HasEveryTick(const ChannelInfo& channel, bool realtime) {
  return channel.schema_name == "mascot_msgs/msg/AgentState" || channel.schema_name == "rosgraph_msgs/msg/Clock" ||
         (channel.schema_name == "mascot_msgs/msg/AgentCommand" && !realtime);
}

/// The proof: every channel counts 0..n-1, and n is the number of ticks wherever there is a sample of each.
/// Returns what contradicts it, or nothing.
std::string Prove(const McapContents& contents, bool realtime, std::optional<std::uint64_t>& ticks) {
  if (!contents.complete) return contents.damage;
  const ChannelInfo* reference = nullptr;
  for (const auto& [id, channel] : contents.channels) {
    if (channel.gaps > 0) return channel.topic + ": gaps in its sequence numbers: " + std::to_string(channel.gaps);
    if (!HasEveryTick(channel, realtime)) continue;
    if (reference == nullptr) reference = &channel;
    if (channel.messages != reference->messages)
      return channel.topic + " has " + std::to_string(channel.messages) + " messages, " + reference->topic + " has " +
             std::to_string(reference->messages);
  }
  if (reference != nullptr) ticks = reference->messages;
  return "";
}

Findings Inspect(const std::string& run) {
  Findings findings;
  findings.file = FindRecording(run);
  findings.contents = ReadMcap(findings.file);
  findings.size_bytes = std::filesystem::file_size(findings.file);
  const Planned planned = PlanOf(findings.contents);
  findings.planned_ticks = planned.ticks;
  findings.reason = Prove(findings.contents, planned.realtime, findings.ticks);
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
          {"ticks", OrNull(findings.ticks)},
          {"planned_ticks", OrNull(findings.planned_ticks)},
          {"complete", findings.complete()},
          {"reason", findings.reason}};
}

void PrintTopics(std::ostream& out, const McapContents& contents) {
  std::size_t topic_width = 5, type_width = 4;
  for (const auto& [id, channel] : contents.channels) {
    topic_width = std::max(topic_width, channel.topic.size());
    type_width = std::max(type_width, channel.schema_name.size());
  }
  const auto row = [&](const auto& topic, const auto& type, const auto& count, const auto& hz) {
    out << "  " << std::left << std::setw(static_cast<int>(topic_width)) << topic << "  "
        << std::setw(static_cast<int>(type_width)) << type << std::right << std::setw(12) << count << std::setw(12)
        << hz << "\n";
  };
  row("topic", "type", "count", "Hz");
  out << std::setprecision(2);
  for (const auto& [id, channel] : contents.channels)
    row(channel.topic, channel.schema_name, channel.messages, Hz(channel));
}

void PrintText(std::ostream& out, const Findings& findings) {
  const McapContents& contents = findings.contents;
  out << std::fixed << std::setprecision(3);
  out << "file:         " << findings.file << "\n";
  out << "size:         " << findings.size_bytes << " bytes\n";
  out << "profile:      " << contents.profile << " (written by " << contents.library << ")\n";
  out << "duration:     " << DurationSeconds(contents) << " s\n";
  out << "messages:     " << contents.messages << "\n";
  out << "chunks:       " << contents.chunks << "\n";
  out << "compression:  " << Ratio(contents) << " to 1\n\n";
  PrintTopics(out, contents);
  out << "\n";
  for (const auto& [name, data] : contents.attachments)
    out << "attachment:   " << name << ", " << data.size() << " bytes\n";
  for (const auto& [name, entries] : contents.metadata) {
    out << "metadata:     " << name << "\n";
    for (const auto& [key, value] : entries) out << "              " << key << " = " << value << "\n";
  }
  if (findings.ticks) {
    const bool early = findings.planned_ticks && *findings.ticks < *findings.planned_ticks;
    out << "ticks:        " << *findings.ticks;
    if (early) out << " of " << *findings.planned_ticks << ": the run ended early";
    out << ", recorded without a gap\n";
  }
  out << "complete: " << (findings.complete() ? "yes" : "no (" + findings.reason + ")") << "\n";
}

int Info(const std::string& run, bool as_json) {
  Findings findings;
  try {
    findings = Inspect(run);
  } catch (const std::exception& error) {  // no such file, no permission, no recording at all
    std::cerr << "error: " << error.what() << "\n";
    return 2;
  }
  if (as_json)
    // A damaged file may hold any bytes in its names.
    std::cout << ToJson(findings).dump(2, ' ', false, Json::error_handler_t::replace) << std::endl;
  else
    PrintText(std::cout, findings);
  return findings.complete() ? 0 : 1;
}

}  // namespace

std::function<int()> SetUpInfo(CLI::App& command) {
  struct Options {
    std::string run;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  command.add_option("run", options->run, "a run folder or an .mcap file")->required();
  command.add_flag("--json", options->json, "print one JSON object and nothing else");
  return [options] { return Info(options->run, options->json); };
}

}  // namespace mascot
