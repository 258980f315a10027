#include "orchestrator/engines/dds/hosts/host_words.h"

#include <sys/stat.h>

#include <fstream>
#include <set>

#include "experiment/experiment.h"
#include "orchestrator/formats/outside_fields.h"
#include "orchestrator/formats/outside_json.h"

namespace mascot {
namespace {

constexpr std::size_t kLongestField = 10'000, kLongestCredentials = 10'000'000;
constexpr double kMaxMemory = 1e15, kLongestSilence_s = 1e9;

/// A text of a list of arguments.
std::string ArgumentFrom(const HostWords& argument) {
  if (!argument.is_string() || argument.get_ref<const std::string&>().size() > kLongestField)
    throw JsonError("expected a text as each of the \"arguments\", got something else");
  return argument.get<std::string>();
}

HostProcess ReadProcess(const HostWords& words) {
  if (!words.is_object()) throw JsonError("expected an object as each of the \"processes\", got something else");
  OutsideFields fields(words);
  HostProcess process{.name = fields.Text("name", kLongestField),
                      .arguments = {},
                      .credentials = fields.Has("credentials") ? fields.Text("credentials", kLongestCredentials) : ""};
  for (const HostWords& argument : fields.List("arguments", 1000)) process.arguments.push_back(ArgumentFrom(argument));
  fields.Require();
  return process;
}

}  // namespace

HostWords WordsOf(const HostHello& hello) {
  return {{"kind", "hello"},          {"build", hello.build},
          {"sources", hello.sources}, {"processor", hello.processor},
          {"machine", hello.machine}, {"seen_from", hello.seen_from}};
}

HostWords WordsOf(const HostJob& job) {
  HostWords words{{"kind", "job"},
                  {"domain", job.domain},
                  {"own_memory", job.own_memory},
                  {"shared_memory", job.shared_memory},
                  {"silence_s", job.silence_s},
                  {"processes", HostWords::array()}};
  for (const HostProcess& process : job.processes) {
    words["processes"].push_back({{"name", process.name}, {"arguments", process.arguments}});
    if (!process.credentials.empty()) words["processes"].back()["credentials"] = process.credentials;
  }
  return words;
}

HostHello ReadHello(const HostWords& words) {
  OutsideFields fields(words);
  const auto text_if_there = [&](const char* key) { return fields.Has(key) ? fields.Text(key, kLongestField) : ""; };
  HostHello hello{.build = fields.Text("build", kLongestField),
                  .sources = text_if_there("sources"),
                  .processor = text_if_there("processor"),
                  .machine = fields.Text("machine", kLongestField),
                  .seen_from = fields.Text("seen_from", kLongestField)};
  fields.Require();
  return hello;
}

HostJob ReadJob(const HostWords& words) {
  OutsideFields fields(words);
  HostJob job{.domain = static_cast<int>(fields.Integer("domain", 0, 232)),
              .own_memory = fields.Boolean("own_memory"),
              .shared_memory = static_cast<std::uint64_t>(fields.Number("shared_memory", 0, kMaxMemory)),
              .silence_s = fields.Number("silence_s", 0, kLongestSilence_s),
              .processes = {}};
  std::set<std::string> names;
  for (const HostWords& process : fields.List("processes", kMaxAgents)) {
    job.processes.push_back(ReadProcess(process));
    if (!names.insert(job.processes.back().name).second)
      throw JsonError("expected each of the \"processes\" once, got one twice");
  }
  fields.Require();
  return job;
}

std::string MachineText() {
  std::string boot;
  std::getline(std::ifstream("/proc/sys/kernel/random/boot_id"), boot);
  struct stat memory {};
  stat("/dev/shm", &memory);
  return boot + " " + std::to_string(memory.st_dev);
}

}  // namespace mascot
