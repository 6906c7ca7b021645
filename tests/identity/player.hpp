#pragma once

// Players of the identity cases: this program, a program built by another compiler, an emulated Cortex-M.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

#include "tests/identity/identity_case.hpp"

namespace proleg::identity {

/// A player cannot play: one line that says why and, where a file is missing, what makes it.
class PlayerError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

enum class Driver : std::uint8_t {
  whole,    ///< one kernel of all joints
  modules,  ///< five kernels of one joint
};

class Player {
 public:
  Player() = default;
  Player(const Player&) = delete;
  Player& operator=(const Player&) = delete;
  virtual ~Player() = default;

  /// Plays a case. Cases are asked for in ascending order, without gaps. The result is valid until the next call.
  /// PlayerError if the case did not run as it should.
  virtual const Trace& play(const ActuationModule& algorithm, std::uint32_t number) = 0;
};

/// For players: the little-endian numbers in bytes. There are four bytes to a value.
void decode(std::span<const std::uint8_t> bytes, std::span<std::int32_t> values);
/// For players: throws unless the case ran without an error and without a missed frame.
void expect_clean(Status status, std::uint32_t missed_frames, std::uint32_t number);

/// Played by the code of this program.
[[nodiscard]] std::unique_ptr<Player> make_native_player(Driver driver);

/// Played by a program made from variant_main.cpp. cases: number of cases it will be asked for.
[[nodiscard]] std::unique_ptr<Player> make_variant_player(const std::filesystem::path& program, Driver driver,
                                                          std::uint32_t cases);

}  // namespace proleg::identity
