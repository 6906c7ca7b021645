#pragma once

#include <memory>
#include <optional>
#include <string>

#include "host/server/server_certificate.hpp"
#include "tools/proleg/common/command_line.hpp"

namespace proleg::tools {

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

}  // namespace proleg::tools
