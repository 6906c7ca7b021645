#pragma once

// Verification of Ed25519 signatures (RFC 8032, section 5.1.7), for a bootloader: small, in fixed memory. There is no
// code that signs.
//
// A signature of a message by the key A consists of R, an encoded point, and S, a number: 32 bytes each, the lowest
// byte first. B is the base point of the curve, and L is the order of B. h is the SHA-512 of the bytes of R, A and the
// message, modulo L. A signature is valid if all of these rules hold:
//   1. A encodes a point (section 5.1.3): its y is below 2^255 - 19, and there is an x.
//   2. The order of A is not 1, 2, 4 or 8. A signature by such a key fits many messages.
//   3. S is below L. Otherwise S + L would be another signature of the same message.
//   4. The encoding of S B - h A is R, byte by byte. So R is canonical, too.
//   5. The order of R is not 1, 2, 4 or 8. A signer does not make such an R.
// RFC 8032 demands rules 1 and 3. It allows rule 4 or the equation with both sides multiplied by 8. Rules 2 and 5 are
// additional. They reject both points with x = 0. So they reject the encodings with a negative 0, as section 5.1.3
// does.
//
// Points whose order is 2 L, 4 L or 8 L are no error: rule 4 alone decides. If the order of A is L, rule 4 rejects
// such an R. A key of such an order is made on purpose by somebody who knows its secret number, and who can sign as
// well with an ordinary key. So a rule against it would protect nobody, and it would cost a multiplication by L.
//
// libsodium 1.0.18 accepts the same signatures; a test compares.
//
// The time depends on the values, all of which are public.

#include <array>
#include <cstdint>
#include <span>

namespace proleg::image {

using PublicKey = std::array<std::uint8_t, 32>;  ///< A
using Signature = std::array<std::uint8_t, 64>;  ///< R, then S

/// Whether a key obeys rules 1 and 2. No signature is valid for another key.
[[nodiscard]] bool is_usable(const PublicKey& key);

/// Whether the signature obeys all rules. `false` is the only error.
[[nodiscard]] bool is_signed_by(const PublicKey& key, const Signature& signature,
                                std::span<const std::uint8_t> message);

}  // namespace proleg::image
