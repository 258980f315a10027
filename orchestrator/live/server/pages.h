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
  /// file of the page. 404 for what is missing, hidden, or outside of these folders. The page that is sent may load
  /// nothing from elsewhere, and talk to nobody but the server that it came from.
  HttpAnswer Get(std::string_view target) const;

 private:
  std::filesystem::path page_;
};

}  // namespace mascot
