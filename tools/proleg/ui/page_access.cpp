#include "tools/proleg/ui/page_access.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <iostream>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "host/server/request_policy.hpp"
#include "shared/computer/errors/input_error.hpp"

namespace proleg::tools {
namespace {

/// Folders for private files, the best first.
std::vector<std::filesystem::path> private_folders() {
  std::vector<std::filesystem::path> folders;
  const char* folder = std::getenv("XDG_RUNTIME_DIR");
  std::error_code error;
  if (folder != nullptr && std::filesystem::is_directory(folder, error)) {
    folders.emplace_back(folder);
  }
  if (std::filesystem::path temporary = std::filesystem::temp_directory_path(error); !error) {
    folders.push_back(std::move(temporary));
  }
  return folders;
}

void ask_to_open(const std::string& reason) {
  std::cerr << "proleg ui: " + reason + "; open the address yourself\n" << std::flush;
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
  const std::string page =
      "<!DOCTYPE html><meta charset=\"utf-8\"><title>Proleg</title><meta http-equiv=\"refresh\" content=\"0; url=" +
      url_ + "\"><a href=\"" + url_ + "\">Proleg</a>\n";
  for (const std::filesystem::path& folder : private_folders()) {
    try {
      host::write_private_file(folder / (name + ".url"), url_ + '\n');
      file_ = folder / (name + ".url");
      host::write_private_file(folder / (name + ".html"), page);
      link_ = folder / (name + ".html");
      return;
    } catch (const FileError&) {  // a folder that is read-only, or full
    }
  }
}

PageAddress::~PageAddress() {
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
  std::filesystem::remove(link_, ignored);
}

void PageAddress::open() const {
  constexpr const char* no_desktop = "there is no desktop with a browser here";
  if (link_.empty()) {
    return ask_to_open("cannot write the file that leads a browser to the page");
  }
  if (!has_desktop()) {
    return ask_to_open(no_desktop);
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
    return ask_to_open(no_desktop);
  }
  // The program that opens the browser may end at once, or with the browser. It stays in the list of processes until
  // its parent has waited for it.
  std::thread([process] {
    int status = 0;
    while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
    }
    if (WIFEXITED(status) && WEXITSTATUS(status) != 0) {
      ask_to_open("the desktop found no browser");
    }
  }).detach();
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

void warn_of_refusal(const std::string& line) {
  print_warning("proleg ui", "a request was refused: " + line + "; behind a reverse proxy see docs/reverse-proxy.md");
}

}  // namespace proleg::tools
