// Parameters that the user has given, and the code never asks for.
#include "agent/laws/custom/looked_up.h"

#include <string_view>
#include <utility>

#include "experiment/toml/section.h"

namespace mascot {
namespace {

// A dict in all that law code does with one. Code that goes through it as a whole, or copies it, has looked up all. A
// subclass that has an __iter__ of its own is also asked for its keys where Python itself copies dicts.
constexpr const char* kWatched = R"python(
class Params(dict):
    """law.params: a dict that knows what was looked up in it."""

    __slots__ = ("_seen", "_note", "_note_all")

    def _look(self, name):
        if isinstance(name, str) and name not in self._seen:
            self._seen.add(name)
            self._note(name, dict.__contains__(self, name))

    def __getitem__(self, name):
        self._look(name)
        return dict.__getitem__(self, name)

    def __contains__(self, name):
        self._look(name)
        return dict.__contains__(self, name)

    def get(self, name, default=None):
        self._look(name)
        return dict.get(self, name, default)

    def pop(self, name, *default):
        self._look(name)
        return dict.pop(self, name, *default)

    def setdefault(self, name, default=None):
        self._look(name)
        return dict.setdefault(self, name, default)

    def __reduce_ex__(self, protocol):
        return dict, (dict(self),)


def noting_all(name):
    original = getattr(dict, name)

    def method(self, *arguments):
        self._note_all()
        return original(self, *arguments)

    return method


for name in ("__iter__", "__reversed__", "__eq__", "keys", "values", "items", "copy", "popitem"):
    setattr(Params, name, noting_all(name))


def watched(params, note, note_all):
    made = Params(params)
    made._seen, made._note, made._note_all = set(), note, note_all
    return made
)python";

}  // namespace

py::object LookedUp::Watched(const py::dict& params, std::shared_ptr<LookedUp> notes) {
  py::dict space;
  py::exec(kWatched, space);
  {
    const std::lock_guard lock(notes->mutex_);
    notes->are_given_ = true;
  }
  return space["watched"](
      params, py::cpp_function([notes](const py::str& name, bool is_there) { notes->Note(TextOf(name), is_there); }),
      py::cpp_function([notes] { notes->TakeAll(); }));
}

void LookedUp::TakeAll() {
  const std::lock_guard lock(mutex_);
  has_all_ = true;
}

void LookedUp::NoteCall() {
  const std::lock_guard lock(mutex_);
  is_called_ = true;
}

void LookedUp::Note(const std::string& name, bool is_there) {
  const std::lock_guard lock(mutex_);
  (is_there ? found_ : missed_).insert(name);
}

std::vector<std::string> LookedUp::Warnings(const Value& params) const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> warnings;
  if (!is_called_ || has_all_) return warnings;
  const std::vector<std::string_view> missed(missed_.begin(), missed_.end());
  for (const auto& [name, value] : std::get<Value::Table>(params.data)) {
    if (found_.contains(name)) continue;
    const auto nearest = DidYouMean(name, missed);
    warnings.push_back("law.params." + name + ": the law has not looked it up" +
                       (nearest       ? ", but \"" + *nearest + "\", which law.params does not have"
                        : !are_given_ ? ": it has neither start(me, params) nor set(me, params)"
                                      : ""));
  }
  return warnings;
}

}  // namespace mascot
