#include "orchestrator/sweeping/job_array.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "orchestrator/sweeping/shard.h"

namespace mascot {
namespace {

/// A word as a shell reads it back.
std::string Quoted(std::string_view word) {
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

/// The name of an option: "--time" of "--time=02:00:00" and of "--time 02:00:00".
std::string_view NameOf(std::string_view option) { return option.substr(0, option.find_first_of("= ")); }

/// Our options of sbatch that the user has not given, then those that he has.
std::vector<std::string> OptionsOf(const JobArray& array) {
  const std::string name = std::filesystem::path(array.out).stem().string();
  std::vector<std::string> all{"--job-name=" + name, fmt::format("--cpus-per-task={}", array.jobs), "--mem-per-cpu=1G",
                               "--time=01:00:00", "--output=" + name + ".%a.log"};
  std::erase_if(all, [&](const std::string& ours) {
    return std::ranges::any_of(array.options,
                               [&](const std::string& theirs) { return NameOf(theirs) == NameOf(ours); });
  });
  all.insert(all.end(), array.options.begin(), array.options.end());
  all.push_back(fmt::format("--array=1-{}", array.tasks));
  all.insert(all.end(), {"--open-mode=append", "--requeue", "--signal=B:USR1@60"});
  return all;
}

}  // namespace

std::string JobArrayScript(const JobArray& array) {
  std::string script = fmt::format(
      "#!/bin/bash\n"
      "# {} runs in {} tasks. Submit this file with sbatch; again, it goes on with what is missing. When all tasks "
      "are\n"
      "# done: orchestrator sweep merge {} --out {}\n",
      array.runs, array.tasks, TablesOfShards(array.out, array.tasks).string(), array.out);
  for (const std::string& option : OptionsOf(array)) script += "#SBATCH " + option + "\n";
  std::vector<std::string> words;
  for (const std::string& word : array.command) words.push_back(Quoted(word));
  script += fmt::format(
      "\n"
      "cd {} || exit\n"
      "{} --shard \"$SLURM_ARRAY_TASK_ID/{}\" --jobs {} --quiet &\n"
      "sweep=$!\n"
      "for signal in USR1 TERM INT; do trap \"kill -$signal $sweep 2>/dev/null\" \"$signal\"; done\n"
      "wait \"$sweep\"\n"
      "code=$?\n"
      "while kill -0 \"$sweep\" 2>/dev/null; do  # a signal has ended the wait, not the sweep\n"
      "  wait \"$sweep\"\n"
      "  code=$?\n"
      "done\n"
      "if [ \"$code\" -eq 138 ]; then  # the time was up\n"
      "  scontrol requeue \"$SLURM_JOB_ID\"\n"
      "fi\n"
      "exit \"$code\"\n",
      Quoted(array.folder), fmt::join(words, " "), array.tasks, array.jobs);
  return script;
}

}  // namespace mascot
