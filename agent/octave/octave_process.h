#pragma once

#include <cstdint>
#include <initializer_list>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "agent/user_code/law_at_work.h"
#include "agent/user_code/law_output.h"
#include "base/value.h"
#include "system/child_process.h"
#include "system/descriptor.h"
#include "system/lifeline.h"
#include "system/private_folder.h"

namespace mascot {

/// A law in MATLAB's language: control.m, and the files beside it whose functions it calls.
struct OctaveCode {
  std::string text;                            ///< of control.m
  std::string file;                            ///< what control.m goes by in messages
  int line = 1;                                ///< line of `file` at which `text` begins
  std::map<std::string, std::string> modules;  ///< texts by file names, such as "saturate.m"
};

/// A mistake in the user's code. what(): Octave's message, in one line.
class OctaveError : public std::runtime_error {
 public:
  OctaveError(const std::string& message, std::string place) : std::runtime_error(message), place_(std::move(place)) {}
  /// Where the mistake is: "law.m:3:7". The file is OctaveCode::file or the name of a module.
  const std::string& place() const { return place_; }

 private:
  std::string place_;
};

/// What the function control looks like.
struct OctaveSignature {
  int inputs = 0;   ///< negative: it takes any number (varargin)
  int outputs = 0;  ///< negative: it returns any number (varargout)
};

/// Values for the function control, each a column of numbers, in the order of agent/octave/octave_driver.h.
class OctaveValues {
 public:
  void Clear() {
    sizes_.clear();
    numbers_.clear();
  }
  void Add(std::span<const double> value) {
    sizes_.push_back(static_cast<double>(value.size()));
    numbers_.insert(numbers_.end(), value.begin(), value.end());
  }
  void Add(double value) { Add({&value, 1}); }

  std::span<const double> sizes() const { return sizes_; }
  std::span<const double> numbers() const { return numbers_; }  ///< of all values, one after the other

 private:
  std::vector<double> sizes_, numbers_;
};

/// One Octave that runs the code of a law: a child process, which answers over pipes. What the code prints is
/// LawOutput. The functions throw OctaveError for mistakes in the user's code, and std::runtime_error if Octave has
/// ended, or is ended because it takes too long or too much memory; then the object cannot be used any more. Used by
/// one thread at a time.
class OctaveProcess {
 public:
  /// Starts Octave, and does not wait for it. `seed`, `stream`: for rand, randn and the like. `max_message`: the
  /// largest number of values in a message. Throws std::runtime_error: "expected Octave, got no octave-cli in PATH: apt
  /// install octave".
  OctaveProcess(const OctaveCode& code, std::uint64_t seed, int stream, std::size_t max_message);
  ~OctaveProcess();
  OctaveProcess(const OctaveProcess&) = delete;
  OctaveProcess& operator=(const OctaveProcess&) = delete;

  /// Waits until Octave has read the code. To be called once, before the others.
  OctaveSignature Begin(const LawLimits& limits);
  /// Gives the next calls of control these parameters, a table.
  void SetParams(const Value& params, const LawLimits& limits);
  /// What control has returned: the wanted vector (2 or 3 finite numbers), and the message (at most max_message).
  struct Answer {
    std::span<const double> wanted, message;  ///< valid until the next call
  };
  Answer Control(const OctaveValues& values, const LawLimits& limits);

 private:
  std::span<const double> Receive(const LawLimits& limits);
  void Send(std::initializer_list<std::span<const double>> numbers, std::int64_t deadline_ns, const LawLimits& limits);
  void Read(std::span<double> numbers, std::int64_t deadline_ns, const LawLimits& limits);
  void Await(short events, int descriptor, std::int64_t deadline_ns, const LawLimits& limits);
  void TakeOutput();
  void RequireLittleMemory(const LawLimits& limits);
  [[noreturn]] void FailAsGarbled() const;
  [[noreturn]] void FailAsEnded();
  [[noreturn]] void FailWith(std::span<const double> text) const;

  std::string file_;
  int line_;
  std::size_t max_message_;
  PrivateFolder folder_;
  Lifeline lifeline_;
  Descriptor to_, from_, printed_;
  ChildProcess process_;
  LawOutput output_{LawOutput::Kind::kUsual};
  std::vector<double> sent_, received_;
  unsigned calls_ = 0;
};

}  // namespace mascot
