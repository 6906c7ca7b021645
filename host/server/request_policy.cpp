#include "host/server/request_policy.hpp"

#include <fcntl.h>
#include <sodium.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "shared/computer/errors/input_error.hpp"

namespace proleg::host {
namespace {

constexpr std::size_t random_bytes = 32;

void initialise_sodium() {
  if (sodium_init() < 0) {
    throw std::runtime_error("libsodium: found no source of random numbers, expected one");
  }
}

constexpr std::string_view bearer = "Bearer ";
constexpr std::array<std::string_view, 3> local_names{"127.0.0.1", "localhost", "[::1]"};
constexpr std::uint16_t https_port = 443;

constexpr std::array<std::pair<unsigned, std::string_view>, 13> statuses{{{200, "OK"},
                                                                          {400, "Bad Request"},
                                                                          {401, "Unauthorized"},
                                                                          {403, "Forbidden"},
                                                                          {404, "Not Found"},
                                                                          {405, "Method Not Allowed"},
                                                                          {409, "Conflict"},
                                                                          {413, "Payload Too Large"},
                                                                          {421, "Misdirected Request"},
                                                                          {426, "Upgrade Required"},
                                                                          {429, "Too Many Requests"},
                                                                          {431, "Request Header Fields Too Large"},
                                                                          {503, "Service Unavailable"}}};

/// The Host of a name. Browsers omit the default port.
std::string host_of(const ServerAddress& address, std::string_view name) {
  return std::string(name) + (address.has_tls && address.port == https_port ? "" : ":" + std::to_string(address.port));
}

std::string origin_of(const ServerAddress& address, std::string_view host) {
  return (address.has_tls ? "https://" : "http://") + std::string(host);
}

/// Whether a Host belongs to this server. A foreign name that resolves to this computer (DNS rebinding) does not.
bool is_own_host(std::string_view host, const ServerAddress& address) {
  const auto is_host = [&](std::string_view name) { return host == host_of(address, name); };
  return std::any_of(local_names.begin(), local_names.end(), is_host) ||
         std::any_of(address.names.begin(), address.names.end(), is_host);
}

RequestDecision refuse(unsigned status) { return {RequestAction::refuse, status}; }

}  // namespace

AccessToken AccessToken::make() {
  initialise_sodium();
  std::array<unsigned char, random_bytes> bytes{};
  randombytes_buf(bytes.data(), bytes.size());
  std::array<char, sodium_base64_ENCODED_LEN(random_bytes, sodium_base64_VARIANT_URLSAFE_NO_PADDING)> text{};
  sodium_bin2base64(text.data(), text.size(), bytes.data(), bytes.size(), sodium_base64_VARIANT_URLSAFE_NO_PADDING);
  return AccessToken(text.data());
}

std::optional<AccessToken> AccessToken::parse(std::string_view text) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  constexpr std::size_t length = sodium_base64_ENCODED_LEN(random_bytes, sodium_base64_VARIANT_URLSAFE_NO_PADDING) - 1;
  if (text.size() != length || text.find_first_not_of(digits) != std::string_view::npos) {
    return std::nullopt;
  }
  return AccessToken(std::string(text));
}

std::string random_digits(unsigned count) {
  initialise_sodium();
  std::string text;
  for (unsigned i = 0; i < count; ++i) {
    text += static_cast<char>('0' + randombytes_uniform(10));
  }
  return text;
}

bool AccessToken::matches(std::string_view candidate) const {
  return candidate.size() == text_.size() && sodium_memcmp(candidate.data(), text_.data(), text_.size()) == 0;
}

void write_private_file(const std::filesystem::path& path, std::string_view text) {
  std::string temporary = path.string() + ".XXXXXX";
  const int descriptor = mkostemp(temporary.data(), O_CLOEXEC);  // creates the file with mode 0600
  if (descriptor < 0) {
    throw FileError(path, std::strerror(errno));
  }
  std::string_view rest = text;
  int error = 0;
  while (!rest.empty() && error == 0) {
    const ssize_t written = ::write(descriptor, rest.data(), rest.size());
    if (written >= 0) {
      rest.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      error = errno;
    }
  }
  if (::close(descriptor) != 0 && error == 0) {
    error = errno;
  }
  if (error == 0 && ::rename(temporary.c_str(), path.c_str()) != 0) {
    error = errno;
  }
  if (error != 0) {
    ::unlink(temporary.c_str());
    throw FileError(path, std::strerror(error));
  }
}

std::string_view path_of(std::string_view target) { return target.substr(0, target.find('?')); }

std::string first_origin(const ServerAddress& address) {
  return origin_of(address, host_of(address, address.names.empty() ? local_names.front() : address.names.front()));
}

std::string socket_origin(const ServerAddress& address, std::string_view host) {
  return (address.has_tls ? "wss://" : "ws://") + std::string(host);
}

RequestDecision decide_request(const RequestFields& request, const ServerAddress& address, const AccessToken& token) {
  if (request.hosts.size() != 1 || !is_own_host(request.hosts.front(), address)) {
    return refuse(421);
  }
  const bool is_post = request.method == "POST";
  if (!is_post && request.method != "GET" && request.method != "HEAD") {
    return refuse(405);
  }
  if (request.origins.size() > 1 ||
      (!request.origins.empty() && request.origins.front() != origin_of(address, request.hosts.front()))) {
    return refuse(403);
  }
  const std::string_view path = path_of(request.target);
  const bool is_join = request.may_join && path == "/join";
  if (is_post != (path == "/stop" || is_join)) {
    return refuse(405);
  }
  if (is_join) {
    return {RequestAction::join, 0};
  }
  if (is_post) {
    const bool has_token = request.authorizations.size() == 1 && request.authorizations.front().starts_with(bearer) &&
                           token.matches(request.authorizations.front().substr(bearer.size()));
    return has_token ? RequestDecision{RequestAction::stop, 0} : refuse(401);
  }
  if (path == "/socket") {
    return request.is_upgrade && request.method == "GET" ? RequestDecision{RequestAction::open_socket, 0} : refuse(426);
  }
  return {RequestAction::serve_file, 0};
}

std::string_view status_words(unsigned status) {
  const auto* const found =
      std::find_if(statuses.begin(), statuses.end(), [status](const auto& entry) { return entry.first == status; });
  return found == statuses.end() ? std::string_view{} : found->second;
}

std::string misdirected_text(const ServerAddress& address) {
  std::string names;
  for (const std::string_view name : local_names) {
    names += (names.empty() ? "" : ", ") + origin_of(address, host_of(address, name));
  }
  for (const std::string& name : address.names) {
    names += ", " + origin_of(address, host_of(address, name));
  }
  const std::string port = std::to_string(address.port);
  return "This page has only these addresses: " + names +
         ".\n\nThrough a tunnel, use the same port on both sides: ssh -L " + port + ":127.0.0.1:" + port +
         " HOST. Each start chooses another port; 'proleg ui --port " + port +
         "' keeps it.\nWithout a tunnel, from another computer: 'proleg ui --lan' with a certificate (docs/page.md).\n";
}

std::string response_header(unsigned status, std::string_view content_type, std::size_t length,
                            std::string_view socket_origin, bool is_kept_alive) {
  std::string text = "HTTP/1.1 " + std::to_string(status) + " ";
  text += status_words(status);
  text += "\r\nContent-Type: ";
  text += content_type;
  text += "\r\nContent-Length: " + std::to_string(length);
  text += is_kept_alive ? "\r\nConnection: keep-alive" : "\r\nConnection: close";
  if (status == 401) {
    text += "\r\nWWW-Authenticate: Bearer";
  } else if (status == 405) {
    text += "\r\nAllow: GET, HEAD, POST";
  } else if (status == 426) {
    text += "\r\nUpgrade: websocket";
  }
  text +=
      "\r\nContent-Security-Policy: default-src 'none'; script-src 'self'; worker-src 'self'; style-src 'self'; "
      "img-src 'self' data: blob:; connect-src 'self'";
  if (!socket_origin.empty()) {
    text += " ";
    text += socket_origin;
  }
  text +=
      "; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
      "\r\nX-Content-Type-Options: nosniff"
      "\r\nCross-Origin-Resource-Policy: same-origin"
      "\r\nReferrer-Policy: no-referrer"
      "\r\nCache-Control: no-store\r\n\r\n";
  return text;
}

}  // namespace proleg::host
