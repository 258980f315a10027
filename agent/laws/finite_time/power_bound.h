#pragma once

#include "experiment/experiment.h"

namespace mascot {

/// The longest time (s) until agents meet, in continuous time and along the slowest axis of the law, whose law is
/// v_i = gain sum_j a_ij sig(p_j - p_i)^alpha on a connected undirected graph; Wang & Xiao (2010).
double LongestTimeOfPower_s(const Experiment& experiment, double gain, double alpha);

}  // namespace mascot
