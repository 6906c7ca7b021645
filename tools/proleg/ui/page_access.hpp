#pragma once

// How people and programs get to the page: its address with the token, and what other computers need.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "host/server/server_certificate.hpp"
#include "tools/proleg/common/command_line.hpp"

namespace proleg::tools {

/// Files that say where a page is, with its token: only their owner may read them, and they go with this object. They
/// are in $XDG_RUNTIME_DIR, or else in the folder for temporary files; if neither can be written there are none.
class PageAddress {
 public:
  /// origin: of the server at this port, e.g. "http://127.0.0.1:8123".
  PageAddress(const std::string& origin, std::uint16_t port, const std::string& token);
  ~PageAddress();
  PageAddress(const PageAddress&) = delete;
  PageAddress& operator=(const PageAddress&) = delete;

  /// ORIGIN/#TOKEN
  [[nodiscard]] const std::string& url() const { return url_; }
  /// Has the address as its only line, for other programs. Empty: there is no file.
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

  /// Opens the page in the browser of the desktop. The command line, which other users of the computer see, has the
  /// name of a file that leads to the page, not the token. If there is no desktop, or nothing there opens a page, one
  /// line on standard error asks the person to do so; it may come later.
  void open() const;

 private:
  std::string url_;
  std::filesystem::path file_;
  std::filesystem::path link_;  ///< an HTML file that leads to the page
};

/// The options for a page that other computers may open.
struct LanOptions {
  bool lan = false;
  std::optional<std::string> certificate;
  std::optional<std::string> key;
};

void add_lan_options(CommandLine& command_line, LanOptions& options);

/// What the server shows to other computers; null without --lan. Prints warnings. Throws InputError, BadInput.
[[nodiscard]] std::shared_ptr<const host::ServerCertificate> open_certificate(const LanOptions& options,
                                                                              const std::string& program);

/// Says on the terminal that the server has refused a request for its Host or Origin.
void warn_of_refusal(const std::string& line);

}  // namespace proleg::tools
