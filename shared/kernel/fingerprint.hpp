#pragma once

#include <cstdint>

namespace proleg {

/// Identifies cores that compute the same joint angles: the CRC-32 of the golden results in tests/identity/golden.tsv,
/// without the line of headings. Two builds with one fingerprint give the same bits. A host refuses to drive modules
/// with a fingerprint that differs from its own. `identity --write-golden` writes it, a test compares it.
inline constexpr std::uint32_t core_fingerprint = 0x29D90EFB;

}  // namespace proleg
