// `orchestrator recover FILE`: makes a whole recording of what a cut or damaged one still holds.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "orchestrator/recording/recording.h"
#include "orchestrator/recording/repair.h"
#include "orchestrator/verbs/new_file.h"
#include "orchestrator/verbs/verb.h"

namespace mascot {
namespace {

struct RecoverArgs {
  std::string file;
  std::optional<std::string> out;
  bool force = false;
};

int Recover(const RecoverArgs& args) {
  const std::string recording = FindRecording(args.file);
  const Repair repair(recording);
  if (repair.damage().empty()) {
    std::cout << recording << ": is whole; nothing is to be recovered" << std::endl;
    return kExitDone;
  }
  const std::string name = std::filesystem::path(recording).stem().string() + ".recovered.mcap";
  const std::string target = NewFile(args.out, name, recording, args.force).string();
  repair.Write(target);
  const std::string end = repair.End();
  std::cout << target << ": kept " << repair.messages() << " messages" << (end.empty() ? "" : ", " + end) << "\n"
            << "damage: " << repair.damage() << "\n"
            << "lost: " << (repair.keeps_all() ? "nothing" : "all messages behind the damage") << std::endl;
  return repair.keeps_all() ? kExitDone : kExitIncomplete;
}

}  // namespace

std::function<int()> SetUpRecover(CLI::App& command) {
  auto args = std::make_shared<RecoverArgs>();
  command.add_option("file", args->file, "a recording (.mcap file) that was cut or damaged, or its run folder")
      ->required()
      ->type_name("FILE");
  command.add_option("--out", args->out, "file, or folder to put it into (default: beside FILE, NAME.recovered.mcap)")
      ->type_name("FILE_OR_DIR");
  command.add_flag("--force", args->force, "replace a file that exists");
  command.footer(
      "Keeps every whole message in front of the damage, and says what is lost.\n"
      "The exit code is 0 if nothing is lost, 3 if something is.");
  return [args] { return Recover(*args); };
}

}  // namespace mascot
