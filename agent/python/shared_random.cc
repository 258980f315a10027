#include "agent/python/shared_random.h"

#include "agent/python/internal.h"

namespace mascot {
namespace {

constexpr const char* kStates = R"python(
import random


def states():
    """The states of the generators that all code shares, by module."""
    found = {"random": repr(random.getstate())}
    try:
        import numpy.random
    except ImportError:
        return found
    state = numpy.random.get_state(legacy=False)
    inner = {name: bytes(value) if name == "key" else value for name, value in state["state"].items()}
    found["numpy.random"] = repr((inner, state["has_gauss"], state["gauss"]))
    return found


def used(before):
    now = states()
    return [name for name in now if now[name] != before.get(name)]
)python";

}  // namespace

struct SharedRandom::States {
  py::dict space, before;
};

SharedRandom::SharedRandom() {
  const PythonLock lock;
  states_ = std::make_unique<States>();
  py::exec(kStates, states_->space, states_->space);
  states_->before = states_->space["states"]();
}

SharedRandom::~SharedRandom() {
  const PythonLock lock;
  states_.reset();
}

std::vector<std::string> SharedRandom::Used() const {
  const PythonLock lock;
  return states_->space["used"](states_->before).cast<std::vector<std::string>>();
}

}  // namespace mascot
