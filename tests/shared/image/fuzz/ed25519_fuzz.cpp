// Any key, signature and message, and signatures by libsodium of which any bytes are changed: they are valid exactly if
// they are for libsodium. The first byte chooses the key, or none; the second is the length of a message.

#include <cstdint>
#include <vector>

#include "ed25519_points.hpp"
#include "tests/support/fuzz_input.hpp"

namespace {

using namespace proleg::image;
using proleg::test::FuzzInput;
using proleg::test::require;

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzInput input({data, size});
  const std::uint8_t owner = input.byte();
  test::Message message(input.byte() % 8U);
  for (std::uint8_t& byte : message) {
    byte = input.byte();
  }
  PublicKey key{};
  Signature signature{};
  if (owner != 0) {
    const test::Scalar secret{owner};
    const test::Scalar r{static_cast<std::uint8_t>(owner ^ 0x80U), 1};
    key = test::multiple_of_base(secret);
    signature = test::signature_of(test::multiple_of_base(r), r, key, secret, message);
    require(is_usable(key) && is_signed_by(key, signature, message), "a signer's signature is valid");
    while (!input.empty()) {
      const std::size_t place = input.byte() % (key.size() + signature.size());
      (place < key.size() ? key[place] : signature[place - key.size()]) = input.byte();
    }
  } else {
    key = input.take<32>();
    signature = input.take<64>();
  }
  const bool is_valid = is_signed_by(key, signature, message);
  require(is_valid == test::is_signed_for_libsodium(key, signature, message), "libsodium agrees");
  require(is_usable(key) || !is_valid, "no signature is valid for a key that is not usable");
  require(test::is_on_curve(key) || !is_usable(key), "a usable key is a point");
  return 0;
}
