#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace proleg::host {

/// The secret that a program must know to use a server: 256 random bits in base64url (43 characters).
class AccessToken {
 public:
  /// Makes a new token from the system's random numbers.
  [[nodiscard]] static AccessToken make();

  [[nodiscard]] const std::string& text() const { return text_; }
  /// Whether the candidate is the token. The duration depends only on the length of `candidate`.
  [[nodiscard]] bool matches(std::string_view candidate) const;

 private:
  explicit AccessToken(std::string text) : text_(std::move(text)) {}

  std::string text_;
};

/// Writes a file that only its owner may read (mode 0600), and replaces a file of this name. The file never exists
/// with another mode or with a part of the text. Throws FileError.
void write_private_file(const std::filesystem::path& path, std::string_view text);

}  // namespace proleg::host
