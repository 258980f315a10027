#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/engines/engine.h"
#include "orchestrator/engines/flight.h"
#include "orchestrator/engines/row_feed.h"
#include "orchestrator/engines/stepped_team.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

class Episodes;

/// Sees episodes: records them, or shows them.
class EpisodeWitness {
 public:
  virtual ~EpisodeWitness() = default;
  /// An episode leaves its tick 0. Returns the sinks that get its rows; none: it passes over this episode, without an
  /// End(). `experiment` lives until End() has returned.
  virtual std::vector<RowSink*> Begin(const Experiment& experiment) = 0;
  /// The sinks have got the row of a tick that is not the last. May wait until it is time for the next, and give events
  /// to `episodes`. Returns false if the episode is to end at this tick.
  virtual bool Await(Episodes& episodes);
  /// The episode is over. Its failure, if it has one, says why it ended early.
  virtual void End(const EngineResult& result) = 0;
};

/// Episodes in this process: those of a Flight each.
class Episodes final : public SteppedTeam {
 public:
  /// `text`, of the file at `path`, with `overrides`, is the experiment. The first episode is at its tick 0. Throws
  /// ConfigError, and what laws throw when they are made.
  Episodes(std::string text, std::string path, std::vector<Override> overrides, Keeps keeps = Keeps::kHistory);
  ~Episodes() override;

  /// From the next episode that leaves its tick 0 on, `witnesses` see the episodes. They must live as long as they are
  /// asked, and until the End() of the last one.
  void SetWitnesses(std::vector<EpisodeWitness*> witnesses) { next_witnesses_ = std::move(witnesses); }

  void Reset(std::vector<Override> changes) override;
  void AwaitStates() override {}
  const Experiment& now() const override { return flight_->now(); }
  std::int64_t tick() const override { return flight_->tick(); }
  const DecodedRow& row() const override { return *row_; }
  std::vector<int> HeardBy(int id) const override;
  /// Agent `id`, which has measured and heard what is to be known at this tick, unless it is lost.
  const Agent& agent(int id) const { return flight_->agent(id); }
  /// The pace that an event of this tick has set; nullopt: none has.
  std::optional<double> new_pace() const { return flight_->new_pace(); }
  bool is_over() const override { return is_over_; }
  const std::string& failure() const override { return result_.failure; }

  void Take(const std::string& toml) override { Take(EventByHand(toml)); }
  void Take(Event event);
  /// Goes on to the next tick, if no witness ends the episode at this one. Throws as GoTo() does.
  void Step();
  void GoTo(std::int64_t tick, const std::function<bool()>& goes_on) override;
  bool Leave() override;
  /// Ends the episode at this tick, if it is not over. Witnesses get what its agents answer, or why a law fails. Throws
  /// what they throw.
  void Finish();

 private:
  void Give(int id, std::span<const double> action) override { flight_->Act(id, action); }
  void Sense();
  void AskWitnesses();
  /// Lets the witnesses wait. Returns whether the episode goes on.
  bool Await();
  /// Lets the agents answer this tick, and hands the row to the witnesses.
  void Answer();
  void End();

  std::vector<EpisodeWitness*> next_witnesses_;
  std::vector<EpisodeWitness*> witnesses_;  // of this episode
  std::unique_ptr<Flight> flight_;
  std::optional<RowFeed> feed_;  // to the witnesses
  const DecodedRow* row_ = nullptr;
  bool is_over_ = false;
  EngineResult result_;
  std::chrono::steady_clock::time_point began_;
};

}  // namespace mascot
