#pragma once

#include <filesystem>
#include <string_view>
#include <utility>

#include "orchestrator/live/server/socket.h"

namespace mascot {

/// The files of the page, of the libraries that it uses, and the results of a run.
class Pages {
 public:
  /// `page`: folder of index.html. `results`: that of a run; empty: there is none.
  explicit Pages(std::filesystem::path page, std::filesystem::path results = {})
      : page_(std::move(page)), results_(std::move(results)) {}
  /// The answer to GET `target`: "/" is index.html, "/vendor/<name>/..." a file of a library of Debian,
  /// "/results/<name>" a picture or the summary of the run, anything else a file of the page. 404 for a file that is
  /// missing, hidden, or outside of these folders. Headers make the page load files only from the server that it came
  /// from, and talk only to this server.
  HttpAnswer Get(std::string_view target) const;

 private:
  std::filesystem::path page_, results_;
};

}  // namespace mascot
