#include "orchestrator/sweeping/cluster/shard.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <map>

#include "experiment/toml/section.h"
#include "orchestrator/sweeping/cluster/job_array.h"

namespace mascot {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// Sets variables of the environment for as long as it lives.
class Environment {
 public:
  explicit Environment(std::map<std::string, std::string> variables) : variables_(std::move(variables)) {
    for (const auto& [name, value] : variables_) setenv(name.c_str(), value.c_str(), 1);
  }
  ~Environment() {
    for (const auto& [name, value] : variables_) unsetenv(name.c_str());
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  std::map<std::string, std::string> variables_;
};

TEST(Shards, ShareAllRunsAndNoneTwice) {
  for (const std::size_t of : {1u, 3u, 7u, 20u})
    for (const std::size_t runs : {0u, 1u, 6u, 7u, 100u}) {
      std::size_t all = 0;
      for (std::size_t number = 1; number <= of; ++number) {
        const Shard shard{number, of};
        std::size_t count = 0;
        for (std::size_t run = 0; run < runs; ++run) count += shard.Has(run);
        EXPECT_EQ(count, shard.CountOf(runs)) << shard.Text() << " of " << runs;
        EXPECT_LE(count, runs / of + 1);
        all += count;
      }
      EXPECT_EQ(all, runs);
    }
}

TEST(Shards, AreReadAsNumberAndCount) {
  const Shard shard = ParseShard("--shard", "3/10");
  EXPECT_EQ(shard.number, 3u);
  EXPECT_EQ(shard.of, 10u);
  EXPECT_EQ(shard.Text(), "3/10");
  for (const char* text :
       {"", "3", "/", "3/", "/4", "0/4", "5/4", "1/0", "-1/4", "1/4/2", "1.0/2", " 1/2", "1/1000001"})
    EXPECT_THAT([&] { ParseShard("--shard", text); },
                ThrowsMessage<ConfigError>("--shard: expected I/N with 1 <= I <= N <= 1000000, got '" +
                                           std::string(text) + "'"));
}

TEST(Shards, HaveTablesOfTheirOwn) {
  EXPECT_EQ(TableOfShard("a/sweep.csv", {3, 10}), "a/sweep.3-of-10.csv");
  EXPECT_EQ(TableOfShard("gain.v1", {1, 2}), "gain.v1.1-of-2");
  EXPECT_EQ(TablesOfShards("sweep.csv", 10), "sweep.*-of-10.csv");
  for (const char* table : {"a/sweep.csv", "gain.v1", "a.2-of-3.csv"})
    EXPECT_EQ(TableOfAll(TableOfShard(table, {3, 10})), table);
  for (const char* name : {"sweep.csv", "3-of-10.csv", "sweep.3-of.csv", "sweep.3-of-10.png", "sweep.3-of-10.csv.plan"})
    EXPECT_FALSE(TableOfAll(name)) << name;
}

TEST(Shards, AreThoseOfTheTaskOfAJobArray) {
  EXPECT_FALSE(ShardOfThisTask());
  {
    const Environment slurm({{"SLURM_ARRAY_TASK_ID", "12"},
                             {"SLURM_ARRAY_TASK_MIN", "10"},
                             {"SLURM_ARRAY_TASK_MAX", "14"},
                             {"SLURM_ARRAY_TASK_COUNT", "5"}});
    EXPECT_EQ(ShardOfThisTask()->Text(), "3/5");
  }
  const Environment gaps({{"SLURM_ARRAY_TASK_ID", "4"},
                          {"SLURM_ARRAY_TASK_MIN", "1"},
                          {"SLURM_ARRAY_TASK_MAX", "7"},
                          {"SLURM_ARRAY_TASK_COUNT", "3"}});
  EXPECT_THAT([] { ShardOfThisTask(); },
              ThrowsMessage<ConfigError>(
                  "--shard: expected I/N, because the tasks of this job array are not numbered one after another"));
  const Environment words(std::map<std::string, std::string>{{"SLURM_ARRAY_TASK_ID", "four"}});
  EXPECT_THAT([] { ShardOfThisTask(); },
              ThrowsMessage<ConfigError>("SLURM_ARRAY_TASK_ID: expected a number, as Slurm sets it, got 'four'"));
}

JobArray Array() {
  return {.command = {"/usr/bin/orchestrator", "sweep", "my file.toml", "--set", "run.name='a b'"},
          .folder = "/home/me/it's",
          .out = "gain.csv",
          .runs = 1000,
          .tasks = 20,
          .jobs = 4,
          .options = {}};
}

TEST(JobArray, AsksForWhatATaskNeeds) {
  EXPECT_THAT(JobArrayScript(Array()),
              AllOf(HasSubstr("#SBATCH --array=1-20\n"), HasSubstr("#SBATCH --cpus-per-task=4\n"),
                    HasSubstr("#SBATCH --mem-per-cpu=1G\n"), HasSubstr("#SBATCH --time=01:00:00\n"),
                    HasSubstr("#SBATCH --job-name=gain\n"), HasSubstr("#SBATCH --open-mode=append\n"),
                    HasSubstr("#SBATCH --signal=B:USR1@60\n"), HasSubstr("#SBATCH --requeue\n"),
                    HasSubstr("\ncd '/home/me/it'\\''s' || exit\n"),
                    HasSubstr("\n/usr/bin/orchestrator sweep 'my file.toml' --set 'run.name='\\''a b'\\''' --shard "
                              "\"$SLURM_ARRAY_TASK_ID/20\" --jobs 4 &\n"),
                    HasSubstr("\n# orchestrator sweep merge gain.*-of-20.csv --out gain.csv\n")));
}

TEST(JobArray, TakesOptionsOfTheClusterInTheirPlace) {
  JobArray array = Array();
  array.options = {"--time=12:00:00", "--partition=long", "--mem-per-cpu 4G", "--array=1-20%5", "--signal=B:USR1@300"};
  const std::string script = JobArrayScript(array);
  for (const std::string& option : array.options) EXPECT_THAT(script, HasSubstr("#SBATCH " + option + "\n"));
  for (const char* name : {"--time", "--mem-per-cpu", "--array", "--signal"}) {
    const std::size_t first = script.find(std::string("#SBATCH ") + name);
    EXPECT_EQ(first, script.rfind(std::string("#SBATCH ") + name)) << name;
  }
}

TEST(JobArray, HasItsLogsBesideTheTableWhateverTheNames) {
  EXPECT_THAT(JobArrayScript(Array()), HasSubstr("#SBATCH --output='/home/me/it'\\''s/gain.%a.log'\n"));
  JobArray array = Array();
  array.out = "to day/100% \"#1\".csv";
  EXPECT_THAT(JobArrayScript(array),
              AllOf(HasSubstr("#SBATCH --job-name='100% \"#1\"'\n"),
                    HasSubstr("#SBATCH --output='/home/me/it'\\''s/to day/100%% \"#1\".%a.log'\n"),
                    HasSubstr("merge 'to day/100% \"#1\".'*-of-20.csv --out 'to day/100% \"#1\".csv'\n")));
  array.out = "/scratch/me/gain.csv";
  EXPECT_THAT(JobArrayScript(array), HasSubstr("#SBATCH --output=/scratch/me/gain.%a.log\n"));
}

TEST(JobArray, RefusesNamesThatSlurmCannotWriteLogsBeside) {
  for (const char* name : {"a\\b", "a\nb"}) {
    JobArray array = Array();
    array.out = std::string(name) + ".csv";
    EXPECT_THAT([&] { JobArrayScript(array); },
                ThrowsMessage<ConfigError>("--out: expected a path without backslashes and line breaks, which Slurm "
                                           "cannot write the logs of tasks beside, got '/home/me/it's/" +
                                           array.out + "'"));
  }
}

}  // namespace
}  // namespace mascot
