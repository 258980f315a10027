#pragma once

// What custom*.cc share: a law written in Python.

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "agent/laws/custom/custom_data.h"
#include "agent/laws/custom/looked_up.h"
#include "agent/laws/laws.h"
#include "agent/laws/parts/law_text.h"
#include "agent/python/internal.h"
#include "experiment/experiment.h"

namespace mascot {

/// Which functions a custom law defines.
enum class PythonStyle {
  kStandard,  ///< control(t, me, neighbours), start, message
  kMascot,    ///< control_user(...) of the published testbed
};

/// A law written in Python.
struct CustomParams final : LawParams, LawText {
  std::shared_ptr<const LawData> data;
  PythonStyle style = PythonStyle::kStandard;
  Wanted wanted = Wanted::kAcceleration;
  Value params;                                                        ///< a table
  std::shared_ptr<LookedUp> looked_up = std::make_shared<LookedUp>();  ///< by the laws of all agents with these params
};

/// The user's text, run in a Python namespace of its own for one agent.
class PythonModule {
 public:
  explicit PythonModule(const CustomParams& params)
      : data_(params.data),
        space_(RunPython(params.text, params.file, params.line, params.modules, params.data->Paths())) {}

  /// PARAMETERS, which the text may define: the parameters that the law takes, with their defaults; else None.
  py::object Parameters() const {
    return space_.contains("PARAMETERS") ? py::object(space_["PARAMETERS"]) : py::none();
  }
  /// The function `name` that the text defines; None if it defines none.
  py::object Function(const char* name) const {
    const py::object function = space_.contains(name) ? py::object(space_[name]) : py::none();
    return PyCallable_Check(function.ptr()) != 0 ? function : py::none();
  }

 private:
  std::shared_ptr<const LawData> data_;  // keeps the files there that the code may read later
  py::dict space_;
};

/// The base of both styles: the time limit, and errors that name the agent, the time and the returned value.
class PythonLaw : public Law {
 public:
  PythonLaw(int id, const CustomParams& params, const LawLimits& limits, const char* function)
      : id_(id),
        who_("the law of agent " + std::to_string(id)),
        limits_(limits),
        wanted_(params.wanted),
        file_(params.file),
        function_(function) {}
  Wanted wanted() const override { return wanted_; }

 protected:
  int id() const { return id_; }

  /// Runs `call`, which calls the user's code, with the time limit. Throws std::runtime_error with the traceback.
  template <class Call>
  auto Guarded(Call call) const {
    try {
      const LimitedPython limited(limits_, who_);
      return call();
    } catch (py::error_already_set& error) {
      throw std::runtime_error(who_ + " failed at t = " + ShortestFloat(t_s_) + " s\n" + Explain(error, file_).what());
    }
  }
  /// Runs `call`, which runs the user's text for the first time, with `limits`. Throws std::runtime_error as Guarded()
  /// does.
  template <class Call>
  void GuardedImport(const LawLimits& limits, Call call) const {
    try {
      const LimitedPython limited(limits, who_);
      call();
    } catch (py::error_already_set& error) {
      throw std::runtime_error(who_ + " failed when it was made\n" + Explain(error, file_).what());
    } catch (const PythonError& error) {
      throw std::runtime_error(who_ + " failed when it was made\n" + error.what());
    }
  }
  void SetTime(double t_s) { t_s_ = t_s; }

  /// `value` as a vector, from two (z = 0) or three finite numbers. `hint`: what a NaN may come from, for the message.
  Eigen::Vector3d ToVector(const py::object& value, const std::string& hint) const {
    const auto numbers = Numbers(value);
    if (!numbers || numbers->size() < 2 || numbers->size() > 3)
      Refuse(value,
             value.is_none() ? ", expected 3 numbers or 2 (has it no return?)" : ", expected 3 numbers or 2 (x, y)");
    const Eigen::Vector3d vector((*numbers)[0], (*numbers)[1], numbers->size() == 3 ? (*numbers)[2] : 0);
    if (!vector.allFinite()) Refuse(value, ", expected finite numbers" + (vector.hasNaN() ? hint : ""));
    return vector;
  }

  [[noreturn]] void Refuse(const py::object& value, const std::string& why) const {
    throw std::runtime_error(who_ + " failed at t = " + ShortestFloat(t_s_) + " s: " + function_ + " returned " +
                             Repr(value) + why);
  }

 private:
  int id_;
  std::string who_;
  LawLimits limits_;
  Wanted wanted_;
  std::string file_;
  std::string function_;
  double t_s_ = 0;
};

/// Limits of the user's code: of a call, and of making the law.
struct CustomLimits {
  LawLimits call, import;
};
/// Makes a law of style "standard".
std::unique_ptr<Law> MakeStandardLaw(const CustomParams& params, const CustomLimits& limits, std::uint64_t seed,
                                     int id);
/// Makes a law of style "mascot", for a team of `agents`. `leader`: 0: none.
std::unique_ptr<Law> MakePublishedLaw(const CustomParams& params, const CustomLimits& limits, int id, int agents,
                                      int leader);

/// Whether its code can draw random numbers by run.seed.
bool CanDraw(const CustomParams& params);

/// The key that may hold the text.
inline constexpr const char* kPythonKey = "python";
/// Runs the text once, to find mistakes in it and the functions that it defines. Returns whether it can send messages.
bool TryText(Section& law, CustomParams& params, const LawLimits& limits);

}  // namespace mascot
