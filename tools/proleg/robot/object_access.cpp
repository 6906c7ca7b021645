#include "tools/proleg/robot/object_access.hpp"

#include <stdexcept>

namespace proleg::tools {

canopen::Object AlgorithmTable::object(std::uint8_t node, const host::ObjectWord& word) const {
  const auto found = ids_.find(node);
  return word.object(word.slot() && found != ids_.end() ? found->second.at(*word.slot()) : std::uint8_t{0});
}

AlgorithmTable read_algorithms(BusAccess& bus, host::SdoQueue& queue, std::span<const std::uint8_t> nodes,
                               std::span<const host::ObjectWord> words) {
  AlgorithmTable table;
  std::string failure;
  for (const host::ObjectWord& word : words) {
    if (!word.slot()) {
      continue;
    }
    const canopen::Address address = canopen::object::slot_algorithm.address(*word.slot());
    for (const std::uint8_t node : nodes) {
      queue.read(node, address, [&, node, slot = *word.slot()](const host::SdoResult& result) {
        if (result.is_good()) {
          table.ids_[node].at(slot) = static_cast<std::uint8_t>(result.number());
        } else {
          failure = failure_text(node, "the algorithm in its slot", result.abort_code, bus.connection().diagnosis());
        }
      });
    }
  }
  finish(bus, queue);
  if (!failure.empty()) {
    throw std::runtime_error(failure);
  }
  return table;
}

std::int64_t raw_number(const canopen::Object& object, const host::SdoResult& result) {
  const std::uint32_t number = canopen::extend(object.type, result.number());
  return canopen::is_signed(object.type) ? std::int64_t{static_cast<std::int32_t>(number)} : std::int64_t{number};
}

}  // namespace proleg::tools
