#pragma once

#include <memory>

#include "tests/cortex_m/machine.hpp"
#include "tests/identity/player.hpp"

namespace proleg::identity {

/// Played by the test image on an emulated CPU, as five modules.
[[nodiscard]] std::unique_ptr<Player> make_cortex_m_player(cortex_m::Cpu cpu);

}  // namespace proleg::identity
