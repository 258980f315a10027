#pragma once

#include <filesystem>
#include <string_view>

#include "orchestrator/live/server/socket.h"

namespace mascot {

/// The files of the page, and of the libraries that it uses.
class Pages {
 public:
  /// `page`: folder of index.html.
  explicit Pages(std::filesystem::path page) : page_(std::move(page)) {}
  /// The answer to GET `target`: "/" is index.html, "/vendor/<name>/..." a file of a library of Debian, anything else a
  /// file of the page. 404 for a file that is missing, hidden, or outside of these folders. Headers make the page load
  /// files only from the server that it came from, and talk only to this server.
  HttpAnswer Get(std::string_view target) const;

 private:
  std::filesystem::path page_;
};

}  // namespace mascot
