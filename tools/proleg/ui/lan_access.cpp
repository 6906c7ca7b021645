#include "tools/proleg/ui/lan_access.hpp"

#include "shared/computer/errors/input_error.hpp"

namespace proleg::tools {
namespace {

constexpr const char* missing_certificate =
    "--lan: found no --certificate, expected a file with a certificate and its key; this makes one: "
    "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 365 -subj \"/CN=$(hostname)\" "
    "-addext \"subjectAltName=DNS:$(hostname)\" -keyout page.pem -out page.pem";

}  // namespace

void add_lan_options(CommandLine& command_line, LanOptions& options) {
  command_line.add_flag("--lan", options.lan, "let other computers open the page, with TLS; needs --certificate");
  command_line.add_option("--certificate", options.certificate, "for --lan: PEM file with a certificate, and its key")
      .value_name("FILE");
  command_line.add_option("--key", options.key, "for --lan: PEM file with the key, if --certificate has none")
      .value_name("FILE");
}

std::shared_ptr<const host::ServerCertificate> open_certificate(const LanOptions& options, const std::string& program) {
  if (!options.lan) {
    if (options.certificate || options.key) {
      throw InputError(options.certificate ? "--certificate" : "--key", 0, "no --lan", "--lan beside it");
    }
    return nullptr;
  }
  if (!options.certificate) {
    throw BadInput(missing_certificate);
  }
  auto certificate =
      std::make_shared<host::ServerCertificate>(*options.certificate, options.key.value_or(*options.certificate));
  for (const std::string& warning : certificate->warnings()) {
    print_warning(program, warning);
  }
  return certificate;
}

}  // namespace proleg::tools
