#pragma once

#include <string>

#include "agent/laws.h"
#include "experiment/experiment.h"

namespace mascot {

/// Which functions a custom law defines.
enum class PythonStyle {
  kStandard,  ///< control(t, me, neighbours), start, message
  kMascot,    ///< control_user(...) of the published testbed
};

inline constexpr EnumNames<PythonStyle, 2> kPythonStyles({{PythonStyle::kStandard, "standard"},
                                                          {PythonStyle::kMascot, "mascot"}});
inline constexpr EnumNames<Wanted, 2> kPythonOutputs({{Wanted::kAcceleration, "acceleration"},
                                                      {Wanted::kVelocity, "velocity"}});

inline constexpr Key kCustomParameters[] = {
    key::Text("python",
              "the law itself: defines control(t, me, neighbours), may define start(me, params), message(me), set(me, "
              "params)"),
    key::Text("file", "a file that holds the law, instead of python; its path from the folder of this file"),
    key::Any("params", "goes to start(me, params) as a dict, and to set(me, params) when an event has changed it")
        .Default("{}")
        .Live(),
    key::OneOf("style", kPythonStyles.names(),
               "mascot: the published testbed's control_user(pos_x, vel_x, acc_x, pos_y, vel_y, acc_y, i, num_agent, "
               "leader)")
        .Default("\"standard\""),
    key::OneOf("output", kPythonOutputs.names(), "what control returns, 3 numbers or 2 (x, y), in W")
        .Default("\"acceleration\""),
    key::Boolean("messages", "whether it sends messages").Otherwise("whether it defines message"),
    key::Integer("leader", 0, kMaxAgents,
                 "for control_user, which counts agents from 0: given as leader - 1, -1 if there is none")
        .Default("0"),
    key::Text("python_file", "what python goes by in messages").Otherwise("this file"),
    key::Integer("python_line", 1, 1'000'000, "the line of python_file at which python begins")
        .Otherwise("where it stands"),
};

}  // namespace mascot
