#include "orchestrator/verbs/viewers.h"

#include <CLI/CLI.hpp>
#include <stdexcept>
#include <utility>

#include "base/utf8.h"
#include "orchestrator/live/server/origin.h"
#include "orchestrator/live/server/qr_code.h"
#include "orchestrator/verbs/show_recording.h"
#include "system/script.h"

namespace mascot {

void AddAllowOrigin(CLI::App& command, std::vector<std::string>& origins) {
  command
      .add_option_function<std::vector<std::string>>(
          "--allow-origin",
          [&origins](const std::vector<std::string>& given) {
            origins.clear();
            for (const std::string& origin : given) origins.push_back(ReadAllowedOrigin(origin));
          },
          "let web pages of this origin watch and steer, such as https://app.foxglove.dev; may be given several times")
      ->type_name("ORIGIN")
      ->allow_extra_args(false);  // otherwise it would take CONFIG as a second value
}

void AddWatchOnly(CLI::App& command, bool& watch_only) {
  command.add_flag("--watch-only", watch_only,
                   "let viewers only watch; the address that is printed as 'steer' is for those who may do more");
}

void AddMetric(CLI::App& command, std::string& file) {
  command
      .add_option("--metric", file,
                  "a Python file: each of its functions of the arrays of a run is a curve on the page, as of sweep")
      ->type_name("FILE");
}

std::unique_ptr<const PythonMetrics> MetricsOf(const std::string& path) try {
  if (path.empty()) return nullptr;
  return std::make_unique<const PythonMetrics>(MetricFile{.path = path, .text = ReadRegularFile(path)});
} catch (const std::runtime_error& failure) {
  throw ConfigError({std::string("--metric: ") + failure.what()});
}

Steering SteeringFor(bool watch_only) { return Steering(watch_only ? Steering::By::kToken : Steering::By::kAll); }

void PrintAddresses(const LiveView& view, Console& console) {
  const std::vector<std::string> addresses = view.addresses();
  const std::string suffix = view.steering_suffix();
  for (const std::string& address : addresses) console.Line("view           " + address);
  if (!suffix.empty()) console.Line("steer          " + addresses.front() + suffix);
  const auto at = ReadHostAndPort(std::string_view(addresses.front()).substr(std::string_view("http://").size()));
  if (!console.is_on_terminal() || !at || IsLoopback(at->host)) return;
  for (const std::string& line : QrCode(addresses.front())) console.Line(line);
}

Viewers::Viewers(const ViewerArgs& args, const std::string& engine, const Experiment& experiment,
                 const Prediction& prediction, const RunMeter& meter, RunRequests& requests, Console& console) try
    : args_(args), console_(console), metrics_(MetricsOf(args.metric_file)) {
  if (!args.at) return;
  view_.emplace(experiment, prediction, meter, requests,
                LiveView::Options{.address = args.at->address,
                                  .port = args.at->port,
                                  .allowed_origins = args.allowed_origins,
                                  .page = FindShared("page", "orchestrator/live"),
                                  .source = {.engine = engine},
                                  .pace = requests.status().pace,
                                  .steering = SteeringFor(args.watch_only)},
                [this](const std::string& line) { Log(line); });
  if (metrics_)
    metric_curves_.emplace(
        experiment, *metrics_, experiment.ticks(), MetricCurves::Rows::kAsTheyCome,
        [this](std::string message) { view_->page().SetMetrics(std::move(message)); },
        [this](const std::string& line) { Log(line); });
  PrintAddresses(view_->page(), console);
} catch (const ConfigError&) {
  throw;
} catch (const std::runtime_error& failure) {
  throw ConfigError({std::string("--view: ") + failure.what()});
}

void Viewers::Log(const std::string& line) {
  const std::lock_guard lock(mutex_);
  console_.Line(line);
  Keep(line);
}

void Viewers::LogTo(const RunFolder& folder) {
  const std::lock_guard lock(mutex_);
  log_ = folder.Log("viewers");
  for (const std::string& line : std::exchange(lines_, {})) Keep(line);
}

void Viewers::Keep(const std::string& line) try {
  if (!log_) return lines_.push_back(line);
  if (no_file_) return;
  if (!file_) file_.emplace(*log_, [this](const std::string& words) { console_.Warning(words); });
  file_->Write(PlainLine(line) + "\n");
} catch (const std::runtime_error& failure) {  // it ends neither view nor run
  no_file_ = true;
  console_.Warning(failure.what());
}

void Viewers::AddTo(std::vector<RowSink*>& sinks) {
  if (!view_) return;
  view_->AddTo(sinks);
  if (metric_curves_) view_->Add(*metric_curves_, sinks);
}

void Viewers::SayHowItEnded(const EngineResult& result) {
  if (view_) view_->SayHowItEnded(result);
}

bool Viewers::Stay() const {
  return view_ && !view_->page().has_failed() &&
         (args_.stay || (console_.is_on_terminal() && view_->page().is_watched()));
}

void Viewers::ShowRecording(const RunFolder& folder, StopSignal& stop) try {
  const LiveView& page = view_->page();
  const Showing showing{.at = {.address = args_.at->address, .port = page.port()},
                        .allowed_origins = args_.allowed_origins,
                        .steering = page.steering(),
                        .metrics = metrics_.get()};
  metric_curves_.reset();
  view_.reset();  // it has the port
  console_.Line("the recording is shown until Ctrl-C");
  mascot::ShowRecording(folder.path().string(), showing, "--view", stop, console_);
} catch (const std::exception& failure) {
  console_.Warning("the recording is not shown: " + std::string(failure.what()));
}

}  // namespace mascot
