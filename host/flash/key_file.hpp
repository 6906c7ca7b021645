#pragma once

// Files with keys of Ed25519, and the signatures of images (shared/image/image_trust.hpp). The files are PEM: a private
// key is PKCS#8 (RFC 8410, section 7), a public key is a SubjectPublicKeyInfo (section 4). `openssl pkey` reads both.
// OpenSSL signs.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "host/flash/image_file.hpp"
#include "shared/image/image_trust.hpp"

namespace proleg::host {

/// A private key. Its bytes are erased from memory when no copy is left.
class SigningKey {
 public:
  /// A new key, of random numbers. Throws std::runtime_error if the system has none.
  [[nodiscard]] static SigningKey make();
  /// Reads a file. Throws InputError if it has no private key of Ed25519, or if a passphrase protects it.
  [[nodiscard]] static SigningKey read(const std::string& file);

  [[nodiscard]] image::PublicKey public_key() const;
  /// The texts of the files with the private and the public key.
  [[nodiscard]] std::string private_text() const;
  [[nodiscard]] std::string public_text() const;

  [[nodiscard]] image::Signature sign(std::span<const std::uint8_t> message) const;

 private:
  explicit SigningKey(std::shared_ptr<void> key) : key_(std::move(key)) {}

  std::shared_ptr<void> key_;  ///< EVP_PKEY, which only the source names
};

/// Writes a private key into a new file, which only its owner can read (mode 0600). Throws InputError if the file
/// exists, unless `replaces`, and std::runtime_error if the file cannot be written.
void write_private_key(const std::string& file, const SigningKey& key, bool replaces);

/// Reads a file with a public key. Throws InputError if it has none of Ed25519, or one that no module takes
/// (image::is_usable()).
[[nodiscard]] image::PublicKey read_public_key(const std::string& file);

/// Sets the key id and the signature of a header whose other fields are complete.
void sign(image::Header& header, const SigningKey& key);

/// An id for people: "1a2b3c4d".
[[nodiscard]] std::string key_id_text(std::uint32_t id);

}  // namespace proleg::host
