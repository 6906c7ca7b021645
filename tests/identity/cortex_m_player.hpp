#pragma once

#include <filesystem>
#include <memory>

#include "tests/cortex_m/machine.hpp"
#include "tests/identity/player.hpp"

namespace proleg::identity {

/// Played by the test image on an emulated CPU, as five modules.
[[nodiscard]] std::unique_ptr<Player> make_cortex_m_player(cortex_m::Cpu cpu);
/// The same with another test image.
[[nodiscard]] std::unique_ptr<Player> make_cortex_m_player(cortex_m::Cpu cpu, const std::filesystem::path& image);

}  // namespace proleg::identity
