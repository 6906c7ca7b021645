#pragma once

// Who may use a server: the secret that a program must have, and what the server does with a request.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace proleg::host {

/// The secret that a program must have to use a server: 256 random bits in base64url (43 characters).
class AccessToken {
 public:
  /// Makes a new token from the system's random numbers.
  [[nodiscard]] static AccessToken make();

  [[nodiscard]] const std::string& text() const { return text_; }
  /// The token that text() gave; nothing for a text that is none.
  [[nodiscard]] static std::optional<AccessToken> parse(std::string_view text);
  /// Whether the candidate is the token. The duration depends only on the length of `candidate`.
  [[nodiscard]] bool matches(std::string_view candidate) const;

 private:
  explicit AccessToken(std::string text) : text_(std::move(text)) {}

  std::string text_;
};

/// Random decimal digits, for a secret that a person types.
[[nodiscard]] std::string random_digits(unsigned count);

/// Writes a file that only its owner may read (mode 0600), and replaces a file of this name. The file never exists
/// with another mode or with a part of the text. Throws FileError.
void write_private_file(const std::filesystem::path& path, std::string_view text);

/// The address at which clients reach a server.
struct ServerAddress {
  std::uint16_t port = 0;
  bool has_tls = false;
  std::vector<std::string> names;        ///< names beside those of this computer; in small letters, as in a URL
  std::vector<std::string> wildcards{};  ///< "*.lab.example": any one label before the rest
};

/// The origin of the first name, or of 127.0.0.1 if there is none: "https://robot.local:8123".
[[nodiscard]] std::string first_origin(const ServerAddress& address);

/// The origin of the WebSocket, such as "wss://robot.local:8123"; `host` is an accepted Host.
[[nodiscard]] std::string socket_origin(const ServerAddress& address, std::string_view host);

/// The fields of an HTTP request that decide about it.
struct RequestFields {
  std::string_view method;
  std::string_view target;
  std::vector<std::string_view> hosts;           ///< every field Host
  std::vector<std::string_view> origins;         ///< every field Origin
  std::vector<std::string_view> authorizations;  ///< every field Authorization
  bool is_upgrade = false;                       ///< the request is for a WebSocket
  bool may_join = false;                         ///< POST /join exists at this server
};

/// The path of a request's target, without the question mark and the text that follows it.
[[nodiscard]] std::string_view path_of(std::string_view target);

enum class RequestAction { refuse, serve_file, open_socket, stop, join };

struct RequestDecision {
  RequestAction action = RequestAction::refuse;
  unsigned status = 0;  ///< HTTP status of a refusal
};

/// Decides what the server at this address does with a request (docs/page-interface.md, "Addresses"). Whether a file
/// exists is not decided here.
[[nodiscard]] RequestDecision decide_request(const RequestFields& request, const ServerAddress& address,
                                             const AccessToken& token);

/// The start of a response, with the empty line. The page may connect to `socket_origin`, which is empty if the server
/// did not accept the request's Host. The body of an error is the text of its status, but for 403 and 421.
[[nodiscard]] std::string response_header(unsigned status, std::string_view content_type, std::size_t length,
                                          std::string_view socket_origin, bool is_kept_alive);

/// What a refusal (403, 421) found and expected, in one line for the person who sets up the way to the server. Texts of
/// the request are shortened and printable.
[[nodiscard]] std::string refusal_line(const RequestFields& request, const ServerAddress& address, unsigned status);

/// The body of 403 and 421: refusal_line(), the names and the port of this server, and what to do about a tunnel whose
/// ends have different ports, and about a reverse proxy.
[[nodiscard]] std::string refusal_text(const RequestFields& request, const ServerAddress& address, unsigned status);

/// The text of a status, such as "Not Found"; empty for a status that the server does not send.
[[nodiscard]] std::string_view status_words(unsigned status);

}  // namespace proleg::host
