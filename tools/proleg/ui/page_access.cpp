#include "tools/proleg/ui/page_access.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <string_view>
#include <system_error>
#include <thread>

#include "host/server/request_policy.hpp"
#include "shared/computer/errors/input_error.hpp"

namespace proleg::tools {
namespace {

std::filesystem::path private_folder() {
  const char* folder = std::getenv("XDG_RUNTIME_DIR");
  std::error_code error;
  if (folder != nullptr && std::filesystem::is_directory(folder, error)) {
    return folder;
  }
  return std::filesystem::temp_directory_path();
}

bool has_desktop() {
  for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY"}) {
    const char* value = std::getenv(name);
    if (value != nullptr && !std::string_view(value).empty()) {
      return true;
    }
  }
  return false;
}

constexpr const char* missing_certificate =
    "--lan: found no --certificate, expected a file with a certificate and its key; this makes one: "
    "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 365 -subj \"/CN=$(hostname)\" "
    "-addext \"subjectAltName=DNS:$(hostname)\" -keyout page.pem -out page.pem";

}  // namespace

PageAddress::PageAddress(const std::string& origin, std::uint16_t port, const std::string& token)
    : url_(origin + "/#" + token) {
  const std::string name = "proleg-ui-" + std::to_string(port);
  file_ = private_folder() / (name + ".url");
  link_ = private_folder() / (name + ".html");
  host::write_private_file(file_, url_ + '\n');
  host::write_private_file(link_,
                           "<!DOCTYPE html><meta charset=\"utf-8\"><title>Proleg</title><meta http-equiv=\"refresh\" "
                           "content=\"0; url=" +
                               url_ + "\"><a href=\"" + url_ + "\">Proleg</a>\n");
}

PageAddress::~PageAddress() {
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
  std::filesystem::remove(link_, ignored);
}

bool PageAddress::open() const {
  if (!has_desktop()) {
    return false;
  }
  std::string program = "xdg-open";
  std::string link = link_.string();
  char* arguments[] = {program.data(), link.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_RDWR, 0);
  }
  pid_t process = 0;
  const int error = posix_spawnp(&process, program.c_str(), &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    return false;
  }
  // The program that opens the browser may end at once, or with the browser. It stays in the list of processes until
  // its parent has waited for it.
  std::thread([process] {
    while (waitpid(process, nullptr, 0) < 0 && errno == EINTR) {
    }
  }).detach();
  return true;
}

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
