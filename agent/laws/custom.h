#pragma once

#include <string>

#include "agent/laws.h"
#include "experiment/experiment.h"

namespace mascot {

inline constexpr std::string_view kPythonStyles[] = {"standard", "mascot"};
inline constexpr std::string_view kPythonOutputs[] = {"acceleration", "velocity"};

inline constexpr Key kCustomParameters[] = {
    key::Text("python",
              "the law itself: defines control(t, me, neighbours), may define start(me, params), message(me)"),
    key::Text("file", "a file that holds the law, instead of python; its path from the folder of this file"),
    key::Any("params", "goes to start(me, params) as a dict").Default("{}"),
    key::OneOf("style", kPythonStyles,
               "mascot: the published testbed's control_user(pos_x, vel_x, acc_x, pos_y, vel_y, acc_y, i, num_agent, "
               "leader)")
        .Default("\"standard\""),
    key::OneOf("output", kPythonOutputs, "what control returns, 3 numbers or 2 (x, y), in W")
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
