#include "orchestrator/live/shown/metric_curves.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "base/utf8.h"

namespace mascot {
namespace {

constexpr auto kBetweenMessages = std::chrono::milliseconds(500);
constexpr int kFailures = 5;     // in a row, are worth a line in the log: the beginning of a run may have no value yet
constexpr int kRestPerWork = 9;  // of a run: so many times as long as it works, the thread rests

}  // namespace

MetricCurves::MetricCurves(const Experiment& experiment, const PythonMetrics& metrics, std::int64_t last_row, Rows rows,
                           std::function<void(std::string)> publish, std::function<void(const std::string&)> log)
    : experiment_(experiment),
      metrics_(metrics),
      last_row_(last_row),
      every_(std::max<std::int64_t>(1, (last_row + kPoints - 1) / kPoints)),
      rows_(rows),
      publish_(std::move(publish)),
      log_(std::move(log)),
      arrays_(experiment) {
  arrays_.Reserve(static_cast<std::size_t>(last_row + 1));
  publish_(Message());
  thread_ = std::jthread([this](const std::stop_token& over) { Run(over); });
}

void MetricCurves::Add(std::int64_t tick, const DecodedRow& row) {
  const std::lock_guard lock(mutex_);
  const auto number = static_cast<std::int64_t>(arrays_.rows());
  arrays_.Add(tick, row);
  ticks_.push_back(tick);
  if (number % every_ == 0 || number == last_row_) changed_.notify_all();
}

/// The row to evaluate next; nothing: there is none yet. The caller holds mutex_.
std::optional<std::int64_t> MetricCurves::NextRow() const {
  const std::int64_t there = static_cast<std::int64_t>(arrays_.rows()) - 1;
  if (there >= last_row_ && evaluated_ + every_ >= last_row_)
    return evaluated_ < last_row_ ? std::optional(last_row_) : std::nullopt;
  const std::int64_t next = rows_ == Rows::kAsTheyCome ? there / every_ * every_ : evaluated_ + every_;
  return next > evaluated_ && next <= there ? std::optional(next) : std::nullopt;
}

void MetricCurves::Run(const std::stop_token& over) {
  while (!over.stop_requested()) {
    std::optional<std::int64_t> row;
    {
      std::unique_lock lock(mutex_);
      if (!changed_.wait(lock, over, [&] { return (row = NextRow()).has_value(); })) return;
      is_idle_ = false;
    }
    const auto begin = WallClock::now();
    Evaluate(*row);
    const auto end = WallClock::now();
    std::unique_lock lock(mutex_);
    evaluated_ = *row;
    const bool is_last = !NextRow();
    if (is_last || end >= published_ + kBetweenMessages) {
      lock.unlock();
      publish_(Message());
      published_ = end;
      lock.lock();
    }
    is_idle_ = is_last;
    changed_.notify_all();
    if (rows_ == Rows::kAsTheyCome && evaluated_ < last_row_)
      changed_.wait_for(lock, over, kRestPerWork * (end - begin), [] { return false; });
  }
}

void MetricCurves::Evaluate(std::int64_t row) {
  std::vector<RunArray> arrays;
  Point& point = points_.emplace_back();
  {
    const std::lock_guard lock(mutex_);
    arrays = arrays_.First(static_cast<std::size_t>(row + 1));
    point.tick = ticks_[static_cast<std::size_t>(row)];
  }
  try {
    point.values = metrics_.Of(arrays);
    error_.clear();
    failures_ = 0;
  } catch (const std::runtime_error& failure) {  // of a part of the run, of which nobody may have thought
    point.values.resize(metrics_.list().size());
    error_ = failure.what();
    if (++failures_ < kFailures && row < last_row_) return;
    if (std::exchange(logged_, error_) != error_) log_("warning: --metric: " + error_);
  }
}

std::string MetricCurves::NoMetrics() { return R"({"metrics":[],"rows":[],"error":""})"; }

std::string MetricCurves::Message() const {
  nlohmann::json message{{"metrics", nlohmann::json::array()}, {"rows", nlohmann::json::array()}, {"error", error_}};
  for (const PythonMetric& metric : metrics_.list())
    message["metrics"].push_back({{"name", metric.name}, {"unit", metric.unit}});
  for (const Point& point : points_) {
    nlohmann::json row = {experiment_.time_s(point.tick)};
    for (const std::optional<double>& value : point.values) row.push_back(value ? nlohmann::json(*value) : nullptr);
    message["rows"].push_back(std::move(row));
  }
  return message.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void MetricCurves::Wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return is_idle_ && !NextRow(); });
}

}  // namespace mascot
