#pragma once

#include <cstdint>
#include <string>

namespace proleg::sim {

/// The tick that a word of the command line names behind its '@': a whole number, or seconds with an `s`, which mean
/// the tick that begins then, or next. Throws InputError with the word as its file.
[[nodiscard]] std::uint32_t read_tick(const std::string& word, const std::string& tick, std::uint32_t tick_period_us);

}  // namespace proleg::sim
