#include "orchestrator/sweeping/cluster/job_array.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "experiment/toml/section.h"
#include "orchestrator/sweeping/cluster/shard.h"
#include "orchestrator/sweeping/table/table.h"

namespace mascot {
namespace {

/// A word as a shell reads it back; sbatch too, unless there is a backslash in it.
std::string Quoted(std::string_view word) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=.,:/@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == word.npos) return std::string(word);
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

/// The name of an option: "--time" of "--time=02:00:00" and of "--time 02:00:00".
std::string_view NameOf(std::string_view option) { return option.substr(0, option.find_first_of("= ")); }

/// The logs of the tasks, beside the table wherever the script is submitted. Slurm puts the task's number for %a and
/// a % for %%; a backslash would make it take both as they are. Throws ConfigError for names that it cannot write.
std::string LogsOf(const JobArray& array) {
  const std::string table = (std::filesystem::path(array.folder) / array.out).lexically_normal().string();
  if (std::ranges::any_of(table, [](char c) { return c == '\\' || (c >= 0 && c < ' '); }))
    throw ConfigError(
        {fmt::format("--out: expected a path without backslashes and line breaks, which Slurm cannot "
                     "write the logs of tasks beside, got '{}'",
                     table)});
  std::string logs;
  for (const char c : FileBeside(table, "").string()) logs += c == '%' ? std::string("%%") : std::string(1, c);
  return logs + ".%a.log";
}

/// Our options of sbatch that the user has not given, then those that he has.
std::vector<std::string> OptionsOf(const JobArray& array) {
  const std::string name = std::filesystem::path(array.out).stem().string();
  std::vector<std::string> all{"--job-name=" + Quoted(name),
                               fmt::format("--array=1-{}", array.tasks),
                               fmt::format("--cpus-per-task={}", array.jobs),
                               "--mem-per-cpu=1G",
                               "--time=01:00:00",
                               "--signal=B:USR1@60",
                               "--requeue",
                               "--output=" + Quoted(LogsOf(array)),
                               "--open-mode=append"};
  std::erase_if(all, [&](const std::string& ours) {
    return std::ranges::any_of(array.options,
                               [&](const std::string& theirs) { return NameOf(theirs) == NameOf(ours); });
  });
  all.insert(all.end(), array.options.begin(), array.options.end());
  return all;
}

/// The command that merges the tables of all tasks.
std::string MergeOf(const JobArray& array) {
  const std::string tables = TablesOfShards(array.out, array.tasks).string();
  const std::size_t star = tables.rfind('*');
  return fmt::format("orchestrator sweep merge {}*{} --out {}", Quoted(tables.substr(0, star)), tables.substr(star + 1),
                     Quoted(array.out));
}

// Slurm tells the shell that its time is up, or the shell and all its processes that they are cancelled; the sweep ends
// in order on the first signal, from whatever process, and takes no notice of more. bash ends `wait` when a signal
// comes.
constexpr char kBody[] = R"sh(
cd {folder} || exit
task=${{SLURM_ARRAY_JOB_ID}}_$SLURM_ARRAY_TASK_ID  # SLURM_JOB_ID is, in one of the tasks, the number of them all
echo "job $task on $(hostname), $(date '+%F %T'), start $((SLURM_RESTART_COUNT + 1))"

told= sweep=
tell() {{ told=$1; [ -z "$sweep" ] || kill -s "$told" "$sweep" 2>/dev/null; }}
for signal in USR1 TERM INT; do trap "tell $signal" "$signal"; done
{command} --shard "$SLURM_ARRAY_TASK_ID/{tasks}" --jobs {jobs} &
sweep=$!
[ -z "$told" ] || tell "$told"  # it came too early
while told=; wait "$sweep"; code=$?; [ -n "$told" ]; do :; done

if [ "$code" -eq 138 ]; then  # USR1: the time was up
  scontrol requeue "$task"
fi
exit "$code"
)sh";

}  // namespace

std::string JobArrayScript(const JobArray& array) {
  std::string script = fmt::format(
      "#!/bin/bash\n"
      "# {} runs in {} tasks. Submit this file with sbatch; again, it goes on with what is missing. When all tasks are "
      "done:\n"
      "# {}\n",
      array.runs, array.tasks, MergeOf(array));
  for (const std::string& option : OptionsOf(array)) script += "#SBATCH " + option + "\n";
  std::vector<std::string> words;
  for (const std::string& word : array.command) words.push_back(Quoted(word));
  return script + fmt::format(kBody, fmt::arg("folder", Quoted(array.folder)),
                              fmt::arg("command", fmt::join(words, " ")), fmt::arg("tasks", array.tasks),
                              fmt::arg("jobs", array.jobs));
}

}  // namespace mascot
