#include "orchestrator/live/server/pages.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>

namespace mascot {
namespace {

namespace fs = std::filesystem;

struct Vendor {
  std::string_view name, folder, package;
};
/// Libraries that the page may use, as Debian ships them.
constexpr Vendor kVendors[] = {
    {"three", "/usr/share/javascript/three", "libjs-three"},
    {"dygraphs", "/usr/share/javascript/dygraphs", "libjs-dygraphs"},
};

struct ContentType {
  std::string_view suffix, type;
};
constexpr ContentType kContentTypes[] = {
    {".html", "text/html; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},
    {".js", "text/javascript; charset=utf-8"},
    {".mjs", "text/javascript; charset=utf-8"},
    {".json", "application/json"},
    {".svg", "image/svg+xml"},
    {".png", "image/png"},
    {".ico", "image/x-icon"},
    {".woff2", "font/woff2"},
};

HttpAnswer NotFound(std::string why) { return {404, {}, std::move(why) + "\n"}; }

/// Whether a path names a file below its folder: no empty or hidden parts, no "..", nothing that needs decoding.
bool IsPlain(std::string_view path) {
  const bool is_known = std::ranges::all_of(path, [](unsigned char c) {
    return std::isalnum(c) != 0 || std::string_view("/._-").find(static_cast<char>(c)) != std::string_view::npos;
  });
  return is_known && !path.empty() && path.front() != '.' && path.front() != '/' &&
         path.find("/.") == std::string_view::npos && path.find("//") == std::string_view::npos;
}

std::optional<std::string> Contents(const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return std::nullopt;
  std::ifstream in(file, std::ios::binary);
  if (!in) return std::nullopt;
  return std::string{std::istreambuf_iterator<char>(in), {}};
}

/// Own files, and connections to the host and port that the page came from: 'self' stands for a WebSocket, too, in
/// browsers since 2022. Nothing of a request is in it. Charts set styles of elements.
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
    "font-src 'self'; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

HttpAnswer Serve(const fs::path& file, std::string why_not) {
  const auto* type =
      std::ranges::find(kContentTypes, file.extension().string(), [](const ContentType& row) { return row.suffix; });
  if (type == std::end(kContentTypes)) return NotFound(std::move(why_not));
  std::optional<std::string> contents = Contents(file);
  if (!contents) return NotFound(std::move(why_not));
  return {.status = 200,
          .headers = {{"Content-Type", std::string(type->type)},
                      {"Cache-Control", "no-cache"},
                      {"Content-Security-Policy", kPolicy},
                      {"Cross-Origin-Resource-Policy", "same-origin"},
                      {"Referrer-Policy", "no-referrer"},
                      {"X-Content-Type-Options", "nosniff"}},
          .body = std::move(*contents)};
}

/// Whether a name is that of a picture or of the summary, in the folder of a run itself.
bool IsResult(const fs::path& name) {
  const auto suffix = name.extension();
  return !name.has_parent_path() && (suffix == ".png" || suffix == ".svg" || name == "summary.json");
}

}  // namespace

HttpAnswer Pages::Get(std::string_view target) const {
  constexpr std::string_view kVendor = "vendor/", kResults = "results/";
  std::string_view path = target.substr(0, target.find('?'));
  if (!path.starts_with('/')) return NotFound("expected a path");
  path.remove_prefix(1);
  if (path.empty()) path = "index.html";
  if (!IsPlain(path)) return NotFound("there is no such file");
  if (path.starts_with(kResults)) {
    const fs::path name = path.substr(kResults.size());
    const bool is_there = !results_.empty() && IsResult(name) && !fs::is_symlink(results_ / name);
    return is_there ? Serve(results_ / name, "there is no such result") : NotFound("there is no such result");
  }
  if (!path.starts_with(kVendor)) return Serve(page_ / path, "there is no such file");
  path.remove_prefix(kVendor.size());
  for (const Vendor& vendor : kVendors)
    if (path.starts_with(std::string(vendor.name) + "/"))
      return Serve(fs::path(vendor.folder) / path.substr(vendor.name.size() + 1),
                   "there is no such file; is Debian's package " + std::string(vendor.package) + " installed?");
  return NotFound("there is no such library");
}

}  // namespace mascot
