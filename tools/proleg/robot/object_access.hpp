#pragma once

// For the subcommands that read and write objects of modules.

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>

#include "host/robot/object_word.hpp"
#include "host/robot/sdo_queue.hpp"
#include "shared/kernel/kernel_configuration.hpp"
#include "tools/proleg/robot/bus_access.hpp"

namespace proleg::tools {

/// The algorithms in the slots of modules, as far as words need them.
class AlgorithmTable {
 public:
  /// Which object a word is for a module. Throws InputError if its algorithm has no such parameter.
  [[nodiscard]] canopen::Object object(std::uint8_t node, const host::ObjectWord& word) const;

 private:
  friend AlgorithmTable read_algorithms(BusAccess&, host::SdoQueue&, std::span<const std::uint8_t>,
                                        std::span<const host::ObjectWord>);
  std::map<std::uint8_t, std::array<std::uint8_t, max_slots>> ids_;  ///< by node
};

/// Reads them, if a word is the name of a parameter. Throws std::runtime_error if a module does not answer.
[[nodiscard]] AlgorithmTable read_algorithms(BusAccess& bus, host::SdoQueue& queue, std::span<const std::uint8_t> nodes,
                                             std::span<const host::ObjectWord> words);

/// The number that travelled, sign-extended.
[[nodiscard]] std::int64_t raw_number(const canopen::Object& object, const host::SdoResult& result);

}  // namespace proleg::tools
