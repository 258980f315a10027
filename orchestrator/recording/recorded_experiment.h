#pragma once

#include <functional>
#include <string>

#include "experiment/experiment.h"
#include "orchestrator/formats/mcap/reader.h"

namespace mascot {

/// The experiment of a recording, to be flown or lived through again.
struct RecordedExperiment {
  Experiment experiment;
  /// How the config.toml beside the recording says another experiment: its first line that differs. Empty: it does not.
  std::string change;
};

/// Reads an experiment. `name`: of the text, in messages.
using ReadExperimentText = std::function<Experiment(const std::string& toml, const std::string& name)>;

/// The experiment that is attached to the recording `file`, whose contents these are, with the processes and the
/// delivery of the config.toml in the folder of the run, and without viewers. A recording that was cut knows of no
/// event after the cut, and the config.toml of a run that was killed of none by hand. `run`: as FindRecording() takes
/// it. Throws what `read` throws.
RecordedExperiment ReadRecordedExperiment(const std::string& run, const std::string& file, const McapContents& contents,
                                          const ReadExperimentText& read);

}  // namespace mascot
