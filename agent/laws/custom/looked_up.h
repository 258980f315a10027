#pragma once

#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "agent/python/internal.h"

namespace mascot {

/// Which parameters of law.params the laws that share them have looked up, to warn of those that no law ever does:
/// their names may be misspelt.
class LookedUp {
 public:
  /// A dict of these parameters, for Python code, that notes in `notes` what is looked up in it. Needs the GIL.
  static py::object Watched(const py::dict& params, std::shared_ptr<LookedUp> notes);
  /// The parameters are declared by the law, and so are known to be its own.
  void TakeAll();
  /// The law has been called, and could have looked them up.
  void NoteCall();

  /// One warning for each of `params` that no law has looked up although it was called.
  std::vector<std::string> Warnings(const Value& params) const;

 private:
  void Note(const std::string& name, bool is_there);

  mutable std::mutex mutex_;
  bool are_given_ = false;  // to start() or set()
  bool is_called_ = false;
  bool has_all_ = false;  // a law went through all of them
  std::set<std::string> found_, missed_;
};

}  // namespace mascot
