#pragma once

#include <cstdint>
#include <mutex>
#include <string>

#include "experiment/experiment.h"
#include "orchestrator/engines/ros_source.h"
#include "orchestrator/live/shown/ui_channels.h"
#include "orchestrator/measuring/run_meter.h"
#include "orchestrator/ros/ros_scene.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// The view of a run for RViz2. The run's thread only copies each row; another thread makes samples of the newest one.
class RosView final : public RowSink, public RosSource {
 public:
  /// Both arguments must outlive this object. `meter` must get each row before this object does.
  RosView(const Experiment& experiment, const RunMeter& meter);

  /// Takes the next row, from the run's thread.
  void Add(const FlownRow& row) override;

  /// Ends the view: the run goes on without it, and the view's thread learns why.
  void Fail(const std::string& why);

  // RosSource, in a thread of its own.
  std::int64_t TakeNewest() override;
  Bytes Transforms() const override;
  Bytes Scene() const override;

 private:
  const Experiment& experiment_;
  const RunMeter& meter_;

  std::mutex mutex_;
  ShownRow newest_;      // guarded by mutex_
  std::string failure_;  // guarded by mutex_

  // The thread of RosSource alone.
  ShownRow shown_;
  RosScene scene_;
  int rows_ = 0;
};

}  // namespace mascot
