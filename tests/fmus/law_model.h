// The model of the FMUs of tests: the consensus law with a memory of its own, and, if its parameter `does` says so,
// what an FMU must not do. The value references are those of pack.py.
#pragma once

#include <unistd.h>

#include <csignal>
#include <cstddef>
#include <fstream>
#include <string>

namespace law_model {

enum Reference : unsigned {
  kP = 1,
  kV = 4,
  kNeighbours = 10,
  kOfNeighbour = 5,
  kGain = 30,
  kBeta = 31,
  kDoes = 40,
  kId = 41,
  kLabel = 50,
  kU = 60,
  kMessage = 63,
  kMatrix = 70
};
enum Does {
  kConsensus,
  kCrash,
  kHang,
  kError,
  kFatal,
  kDiscard,
  kEnd,
  kClock,
  kNotANumber,
  kLose,
  kSecondRow,  // u is the second row of the matrix
  kResources,  // u[1]: the number in resources/gains.txt; u[2]: 1 if tool.sh may be executed, -1 if gains.txt may
  kWarn        // logs, if its category is to be logged, and goes on
};

struct Model {
  double p[3] = {}, v[3] = {}, neighbours[10] = {};  // of each of two places: p, weight, heard
  double matrix[6] = {};                             // p of both places, a row for each
  double p_gain = 1, beta = 1;
  int does = kConsensus, id = 0;
  std::string label = "none", resources;  // a path that ends in '/'
  bool logs_errors = false;
  double u[3] = {}, message = 0;
  double t = 0;
  int steps = 0;

  /// Where a real variable is; null: there is none.
  double* Real(unsigned reference) {
    if (reference >= kP && reference < kP + 3) return p + (reference - kP);
    if (reference >= kV && reference < kV + 3) return v + (reference - kV);
    if (reference >= kNeighbours && reference < kNeighbours + 2 * kOfNeighbour)
      return neighbours + (reference - kNeighbours);
    if (reference >= kMatrix && reference < kMatrix + 6) return matrix + (reference - kMatrix);
    if (reference == kGain) return &p_gain;
    if (reference == kBeta) return &beta;
    if (reference >= kU && reference < kU + 3) return u + (reference - kU);
    return reference == kMessage ? &message : nullptr;
  }
  /// No gain may become negative once the model has stepped.
  bool Refuses(unsigned reference, double value) const { return reference == kGain && value < 0 && steps > 0; }
  int* Integer(unsigned reference) { return reference == kDoes ? &does : reference == kId ? &id : nullptr; }

  void Step(double from, double step) {
    if (does == kCrash) std::raise(SIGSEGV);
    for (volatile bool hangs = does == kHang; hangs;) {
    }
    for (int k = 0; k < 3; ++k) {
      u[k] = 0;
      for (int place = 0; place < 2; ++place) {
        const double* const one = neighbours + static_cast<std::size_t>(place) * kOfNeighbour;
        if (one[4] != 0) u[k] += one[3] * p_gain * (one[k] - p[k]);
      }
      u[k] -= beta * v[k];
    }
    if (does == kClock) u[0] = from, u[1] = from + step;
    for (int k = 0; k < 3 && does == kSecondRow; ++k) u[k] = matrix[3 + k];
    if (does == kResources) {
      std::ifstream(resources + "gains.txt") >> u[0];
      u[1] = ::access((resources + "tool.sh").c_str(), X_OK) == 0 ? 1 : 0;
      if (::access((resources + "gains.txt").c_str(), X_OK) == 0) u[1] = -1;
    }
    if (does == kNotANumber) u[0] = 0.0 / (step - step);
    message = ++steps;
    t = from + step;
  }
};

}  // namespace law_model
