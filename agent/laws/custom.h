#pragma once

#include <string>

#include "agent/laws.h"
#include "experiment/experiment.h"
#include "experiment/value.h"

namespace mascot {

/// How the functions of a custom law look.
enum class PythonStyle {
  kStandard,  ///< control(t, me, neighbours), start, message
  kMascot,    ///< control_user(...) of the published testbed
};

/// A law written in Python, and where it stands.
struct CustomParams {
  std::string text;
  std::string file;  ///< as it goes by in messages
  int line = 1;      ///< of `file`, at which `text` begins
  PythonStyle style = PythonStyle::kStandard;
  Wanted wanted = Wanted::kAcceleration;
  Value params;             ///< a table
  double time_limit_s = 0;  ///< that one call may take
};

inline constexpr LawParameter kCustomParameters[] = {
    {"python", "", "text",
     "the law itself: defines control(t, me, neighbours), may define start(me, params), message(me)"},
    {"file", "", "a path, from the folder of this file", "a file that holds the law, instead of python"},
    {"params", "{}", "any table", "goes to start(me, params) as a dict"},
    {"style", "\"standard\"", "standard | mascot",
     "mascot: the published testbed's control_user(pos_x, vel_x, acc_x, pos_y, vel_y, acc_y, i, num_agent, leader)"},
    {"output", "\"acceleration\"", "acceleration | velocity", "what control returns, 3 numbers or 2 (x, y), in W"},
    {"messages", "", "true | false", "whether it sends messages; by default: whether it defines message"},
    {"leader", "0", "0..N", "for control_user, which counts agents from 0: given as leader - 1, -1 if there is none"},
    {"python_file", "", "text", "what python goes by in messages; by default this file"},
    {"python_line", "", ">= 1", "the line of python_file at which python begins"},
};

}  // namespace mascot
