#pragma once

#include <string_view>

namespace mascot {

/// The names of the driver's file, and of the file that it calls: the law.
inline constexpr std::string_view kOctaveDriver = "mascot_driver.m", kOctaveLaw = "control.m";
/// The code in Octave that calls a law, and speaks with OctaveProcess over pipes.
///
/// What is said is a number n and n numbers, all doubles in the machine's order. To the driver, the first of the n is:
///   0: it is to read the law's files. Answer: how many inputs and outputs control has, negative if it is any number.
///   1: the parameters follow, as characters of an expression. No answer.
///   2: it is to call control. The number of values follows, how many numbers each value has, and these. The values are
///      the time; of this agent: id, position, velocity, acceleration, orientation, angular_velocity, ranges, message;
///      of each neighbour: id, position, velocity, acceleration, orientation, angular_velocity, weight, age_s, message.
///      Answer: how many numbers the wanted vector has, these, and those of the message.
/// From the driver, the first is 0, and then the answer; or it is 1, and then the characters of four lines follow:
/// file, line and column of a mistake, and the message, which may have more lines. After that the driver is of no use.
extern const std::string_view kOctaveDriverText;

}  // namespace mascot
