#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/engines/engine.h"
#include "orchestrator/engines/run_control.h"
#include "orchestrator/live/address.h"
#include "orchestrator/live/live_view.h"
#include "orchestrator/processes/console.h"

namespace mascot {

/// Those who watch a run of `up`, if the user asked for --view.
class Viewers {
 public:
  /// Listens at `at`, if it is given, and prints where. All arguments but the first two must outlive this object.
  /// Throws ConfigError if nobody could watch.
  Viewers(const std::optional<LiveAddress>& at, const std::string& engine, const Experiment& experiment,
          const Prediction& prediction, const RunMeter& meter, Console& console);

  void AddTo(std::vector<RowSink*>& sinks);
  /// Viewers see how the run ended until this object ends, which closes their connections.
  void SayHowItEnded(const EngineResult& result);

 private:
  /// The control of a run that takes no wishes.
  class NoControl final : public RunControl {
   public:
    Answer Ask(const Wish& wish) override;
  };

  const double pace_;
  NoControl control_;
  std::optional<LiveView> view_;
};

}  // namespace mascot
