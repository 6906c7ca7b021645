#include "host/flash/key_file.hpp"

#include <fcntl.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <stdexcept>

#include "shared/computer/errors/input_error.hpp"

namespace proleg::host {
namespace {

constexpr const char* a_private_key = "a private key of Ed25519 in PEM, as 'proleg image key' makes it";
constexpr const char* a_public_key = "a public key of Ed25519 in PEM, as 'proleg image key' makes it";

EVP_PKEY* pointer(const std::shared_ptr<void>& key) { return static_cast<EVP_PKEY*>(key.get()); }

std::shared_ptr<void> owned(EVP_PKEY* key) {
  return {key, [](void* old) { EVP_PKEY_free(static_cast<EVP_PKEY*>(old)); }};
}

void check(bool is_right) {
  if (!is_right) {
    throw std::runtime_error("libcrypto: found an error with a key of Ed25519, expected none");
  }
}

struct FreeBio {
  void operator()(BIO* bio) const { BIO_free(bio); }
};
using Bio = std::unique_ptr<BIO, FreeBio>;

/// A text that OpenSSL writes.
std::string written(const std::function<int(BIO*)>& write) {
  // The memory is erased when it is freed, because the text can be that of a private key.
  const Bio bio(BIO_new(BIO_s_secmem()));
  check(bio != nullptr && write(bio.get()) == 1);
  char* text = nullptr;
  const long size = BIO_get_mem_data(bio.get(), &text);
  return {text, static_cast<std::size_t>(size)};
}

/// OpenSSL asks this function for a passphrase; there is none, so it does not ask a terminal.
int no_passphrase(char* /*text*/, int /*size*/, int /*writes*/, void* was_asked) {
  *static_cast<bool*>(was_asked) = true;
  return -1;
}

std::shared_ptr<void> read_key(const std::string& file, bool is_private, const char* expected) {
  const std::vector<std::uint8_t> bytes = read_bytes(file, expected);
  const Bio bio(BIO_new_mem_buf(bytes.data(), static_cast<int>(bytes.size())));
  check(bio != nullptr);
  bool was_asked = false;
  EVP_PKEY* const key = is_private ? PEM_read_bio_PrivateKey(bio.get(), nullptr, no_passphrase, &was_asked)
                                   : PEM_read_bio_PUBKEY(bio.get(), nullptr, no_passphrase, &was_asked);
  if (was_asked) {
    throw InputError(file, 0, "a key that a passphrase protects",
                     "one without: 'openssl pkey -in FILE -out NEW' removes it");
  }
  if (key == nullptr) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const bool has_other = text.find(is_private ? "BEGIN PUBLIC KEY" : "PRIVATE KEY-----") != std::string_view::npos;
    throw InputError(file, 0, has_other ? (is_private ? "a public key" : "a private key") : "no key in PEM", expected);
  }
  std::shared_ptr<void> owner = owned(key);
  if (EVP_PKEY_get_base_id(key) != EVP_PKEY_ED25519) {
    throw InputError(file, 0, "a key of another kind", expected);
  }
  return owner;
}

image::PublicKey public_key_of(const std::shared_ptr<void>& key) {
  image::PublicKey bytes{};
  std::size_t size = bytes.size();
  check(EVP_PKEY_get_raw_public_key(pointer(key), bytes.data(), &size) == 1 && size == bytes.size());
  return bytes;
}

}  // namespace

SigningKey SigningKey::make() {
  for (;;) {
    EVP_PKEY* const key = EVP_PKEY_Q_keygen(nullptr, nullptr, "ED25519");
    check(key != nullptr);
    SigningKey made(owned(key));
    if (image::key_id(made.public_key()) != 0) {  // the id of one of 2^32 keys means "not signed"
      return made;
    }
  }
}

SigningKey SigningKey::read(const std::string& file) { return SigningKey(read_key(file, true, a_private_key)); }

image::PublicKey SigningKey::public_key() const { return public_key_of(key_); }

std::string SigningKey::private_text() const {
  return written([this](BIO* bio) {
    return PEM_write_bio_PKCS8PrivateKey(bio, pointer(key_), nullptr, nullptr, 0, nullptr, nullptr);
  });
}

std::string SigningKey::public_text() const {
  return written([this](BIO* bio) { return PEM_write_bio_PUBKEY(bio, pointer(key_)); });
}

image::Signature SigningKey::sign(std::span<const std::uint8_t> message) const {
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
  image::Signature signature{};
  std::size_t size = signature.size();
  check(context != nullptr && EVP_DigestSignInit(context.get(), nullptr, nullptr, nullptr, pointer(key_)) == 1 &&
        EVP_DigestSign(context.get(), signature.data(), &size, message.data(), message.size()) == 1 &&
        size == signature.size());
  return signature;
}

void write_private_key(const std::string& file, const SigningKey& key, bool replaces) {
  // The text goes into a new file, so that a program that has opened the old one cannot read it.
  const std::string temporary = file + ".new";
  unlink(temporary.c_str());
  const int descriptor = open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (descriptor < 0) {
    throw InputError(file, 0, std::string("a file that cannot be written (") + std::strerror(errno) + ")",
                     "a folder in which a file can be made");
  }
  const std::string text = key.private_text();
  const bool is_written =
      write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size()) && fsync(descriptor) == 0;
  const int error = close(descriptor) == 0 && is_written ? 0 : errno;
  // link() fails if the file exists: two programs cannot both make it.
  const bool is_named = error == 0 && (replaces ? std::rename(temporary.c_str(), file.c_str()) == 0
                                                : link(temporary.c_str(), file.c_str()) == 0);
  const int name_error = errno;
  unlink(temporary.c_str());
  if (error == 0 && !is_named && name_error == EEXIST) {
    throw InputError(file, 0, "a file that exists",
                     "a new name, or --force, with which the private key in the file is lost");
  }
  if (!is_named) {
    throw std::runtime_error(file + ": found the error '" + std::strerror(error != 0 ? error : name_error) +
                             "', expected to write the key");
  }
}

image::PublicKey read_public_key(const std::string& file) {
  const image::PublicKey key = public_key_of(read_key(file, false, a_public_key));
  if (!image::may_be_trusted(key)) {
    throw InputError(file, 0, "a key that fits signatures of anybody", a_public_key);
  }
  return key;
}

void sign(image::Header& header, const SigningKey& key) {
  header.key_id = image::key_id(key.public_key());
  header.signature = key.sign(image::signed_bytes(image::encode(header)));
}

std::string key_id_text(std::uint32_t id) {
  char digits[9];
  std::snprintf(digits, sizeof(digits), "%08x", static_cast<unsigned>(id));
  return digits;
}

}  // namespace proleg::host
