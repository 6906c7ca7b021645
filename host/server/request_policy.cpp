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
#include "shared/computer/text/text.hpp"

namespace proleg::host {
namespace {

constexpr std::size_t random_bytes = 32;

void initialise_sodium() {
  if (sodium_init() < 0) {
    throw std::runtime_error("libsodium: found no source of random numbers, expected one");
  }
}

constexpr std::string_view bearer = "bearer ";  // the word has no case (RFC 9110, section 11.1)
constexpr std::array<std::string_view, 3> local_names{"127.0.0.1", "localhost", "[::1]"};
constexpr std::uint16_t http_port = 80;
constexpr std::uint16_t https_port = 443;

constexpr unsigned forbidden = 403;

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

std::uint16_t default_port(const ServerAddress& address) { return address.has_tls ? https_port : http_port; }

/// The Host of a name. Browsers omit the default port.
std::string host_of(const ServerAddress& address, std::string_view name) {
  return std::string(name) + (address.port == default_port(address) ? "" : ":" + std::to_string(address.port));
}

std::string_view scheme_of(const ServerAddress& address) { return address.has_tls ? "https://" : "http://"; }

std::string origin_of(const ServerAddress& address, std::string_view host) {
  return std::string(scheme_of(address)) + std::string(host);
}

bool is_below(std::string_view name, std::string_view wildcard) {
  const std::string_view rest = wildcard.substr(1);  // ".lab.example"
  if (!name.ends_with(rest)) {
    return false;
  }
  const std::string_view label = name.substr(0, name.size() - rest.size());
  constexpr std::string_view allowed = "abcdefghijklmnopqrstuvwxyz0123456789-_";
  return !label.empty() && label.find_first_not_of(allowed) == std::string_view::npos;
}

/// A Host or the rest of an Origin: names have no case and may end in the dot of the root (RFC 3986, section 3.2.2),
/// and the default port may be there or not.
struct HostName {
  std::string name;  ///< empty: it is not of this form
  std::string port;
};

HostName read_host(std::string_view text, const ServerAddress& address) {
  const std::size_t end = text.starts_with('[') ? text.find(']') : 0;
  const std::size_t colon = end == std::string_view::npos ? end : text.find(':', end);
  HostName host{lower_case(text.substr(0, colon)),
                std::string(colon == std::string_view::npos ? "" : text.substr(colon + 1))};
  if (colon == std::string_view::npos) {
    host.port = std::to_string(default_port(address));
  }
  if (host.name.size() > 1 && host.name.ends_with('.')) {
    host.name.pop_back();
  }
  return host;
}

/// Whether the name is one of this server. A foreign name that resolves to this computer (DNS rebinding) is not.
bool is_own_name(const std::string& name, const ServerAddress& address) {
  return std::ranges::find(local_names, name) != local_names.end() ||
         std::ranges::find(address.names, name) != address.names.end() ||
         std::ranges::any_of(address.wildcards, [&](const auto& wildcard) { return is_below(name, wildcard); });
}

bool is_own_host(std::string_view text, const ServerAddress& address) {
  const HostName host = read_host(text, address);
  return host.port == std::to_string(address.port) && is_own_name(host.name, address);
}

/// Whether an Origin is that of an accepted Host.
bool is_origin_of(std::string_view origin, std::string_view host, const ServerAddress& address) {
  const std::string_view scheme = scheme_of(address);
  if (!origin.starts_with(scheme)) {
    return false;
  }
  const HostName found = read_host(origin.substr(scheme.size()), address);
  const HostName expected = read_host(host, address);
  return found.name == expected.name && found.port == expected.port;
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
      (!request.origins.empty() && !is_origin_of(request.origins.front(), request.hosts.front(), address))) {
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
    const bool has_token = request.authorizations.size() == 1 &&
                           lower_case(request.authorizations.front().substr(0, bearer.size())) == bearer &&
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

std::string refusal_line(const RequestFields& request, const ServerAddress& address, unsigned status) {
  const auto quoted = [](std::string_view text) { return in_quotes(one_line(shortened(std::string(text)))); };
  if (status == forbidden) {
    return "Origin: found " +
           (request.origins.size() > 1 ? std::to_string(request.origins.size()) + " of them"
                                       : quoted(request.origins.front())) +
           ", expected that of the Host, " + quoted(origin_of(address, request.hosts.front()));
  }
  const std::string expected = host_of(address, address.names.empty() ? local_names.front() : address.names.front());
  std::string found = request.hosts.empty() ? "none" : std::to_string(request.hosts.size()) + " of them";
  if (request.hosts.size() == 1) {
    // A browser has the wrong port from the address that the person has typed.
    found = is_own_name(read_host(request.hosts.front(), address).name, address) ? "another port"
                                                                                 : quoted(request.hosts.front());
  }
  return "Host: found " + found + ", expected a name and the port of this page, such as " + quoted(expected);
}

std::string refusal_text(const RequestFields& request, const ServerAddress& address, unsigned status) {
  std::string names;
  const auto add = [&](std::string_view name) {
    names += (names.empty() ? "" : ", ") + origin_of(address, host_of(address, name));
  };
  std::ranges::for_each(local_names, add);
  std::ranges::for_each(address.names, add);
  std::ranges::for_each(address.wildcards, add);
  const std::string port = std::to_string(address.port);
  return refusal_line(request, address, status) + ".\n\nThis page has only these addresses: " + names +
         ".\n\nThrough a tunnel, use the same port on both sides: ssh -L " + port + ":127.0.0.1:" + port +
         " HOST. Each start chooses another port; 'proleg ui --port " + port +
         "' keeps it.\nBehind a reverse proxy, set Host and Origin there (docs/reverse-proxy.md)."
         "\nWithout either, from another computer: 'proleg ui --lan' with a certificate (docs/page.md).\n";
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
