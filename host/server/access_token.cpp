#include "host/server/access_token.hpp"

#include <fcntl.h>
#include <sodium.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "shared/computer/errors/input_error.hpp"

namespace proleg::host {
namespace {

constexpr std::size_t random_bytes = 32;

void initialise_sodium() {
  if (sodium_init() < 0) {
    throw std::runtime_error("libsodium: found no source of random numbers, expected one");
  }
}

}  // namespace

AccessToken AccessToken::make() {
  initialise_sodium();
  std::array<unsigned char, random_bytes> bytes{};
  randombytes_buf(bytes.data(), bytes.size());
  std::array<char, sodium_base64_ENCODED_LEN(random_bytes, sodium_base64_VARIANT_URLSAFE_NO_PADDING)> text{};
  sodium_bin2base64(text.data(), text.size(), bytes.data(), bytes.size(), sodium_base64_VARIANT_URLSAFE_NO_PADDING);
  return AccessToken(text.data());
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

}  // namespace proleg::host
