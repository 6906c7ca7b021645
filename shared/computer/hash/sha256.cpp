#include "shared/computer/hash/sha256.hpp"

#include <openssl/evp.h>

#include <stdexcept>

namespace proleg {
namespace {

using Digest = std::array<unsigned char, 32>;

/// Checks the result of a function of libcrypto: 1 is success. SHA-256 fails only without memory.
void check(int result) {
  if (result != 1) {
    throw std::runtime_error("libcrypto: cannot compute a SHA-256");
  }
}

}  // namespace

std::string sha256_hex(std::string_view text) {
  Digest digest;
  check(EVP_Digest(text.data(), text.size(), digest.data(), nullptr, EVP_sha256(), nullptr));
  return hexadecimal_digits(digest);
}

std::string hexadecimal_digits(std::span<const unsigned char> bytes) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : bytes) {
    text += digits[byte >> 4U];
    text += digits[byte & 15U];
  }
  return text;
}

void ValueHash::Free::operator()(EVP_MD_CTX* context) const { EVP_MD_CTX_free(context); }

ValueHash::ValueHash() : context_(EVP_MD_CTX_new()) {
  check(context_ == nullptr ? 0 : EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr));
}

void ValueHash::append(std::span<const std::int32_t> values) {
  for (const std::int32_t value : values) {
    append(value);
  }
}

void ValueHash::append_buffer() {
  check(EVP_DigestUpdate(context_.get(), buffer_.data(), buffered_));
  buffered_ = 0;
}

std::string ValueHash::hex() const {
  // Finishing destroys the state, so a copy is finished.
  const std::unique_ptr<EVP_MD_CTX, Free> copy(EVP_MD_CTX_new());
  check(copy == nullptr ? 0 : EVP_MD_CTX_copy_ex(copy.get(), context_.get()));
  check(EVP_DigestUpdate(copy.get(), buffer_.data(), buffered_));
  Digest digest;
  check(EVP_DigestFinal_ex(copy.get(), digest.data(), nullptr));
  return hexadecimal_digits(digest);
}

}  // namespace proleg
