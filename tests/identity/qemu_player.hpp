#pragma once

#include <filesystem>
#include <memory>

#include "tests/identity/player.hpp"

namespace proleg::identity {

/// Played by the test image for Cortex-M4 in QEMU, as five modules: an emulator that has nothing of the one of
/// make_cortex_m_player(). program: qemu-system-arm.
[[nodiscard]] std::unique_ptr<Player> make_qemu_player(const std::filesystem::path& program,
                                                       const std::filesystem::path& image);

}  // namespace proleg::identity
