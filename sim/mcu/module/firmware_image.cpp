#include "sim/mcu/module/firmware_image.hpp"

#include <algorithm>

#include "firmware/stm32f405/flash_layout.hpp"

namespace proleg::sim {
namespace {

constexpr const char* record_symbol = "proleg_tick_record";

}  // namespace

FirmwareImage::FirmwareImage(const std::filesystem::path& file) : file_(file), flash_(file) {
  const auto& symbols = flash_.elf().symbols();
  const auto symbol = std::ranges::find(symbols, record_symbol, &ElfImage::Symbol::name);
  if (symbol == symbols.end()) {
    throw ElfError(file.string() + ": found no symbol " + record_symbol +
                   ", expected the firmware of a joint module for this chip (firmware/stm32f405)");
  }
  flash_.require_vector_table(stm32f405::flash_layout::image_body);  // behind the start stub
  tick_record_ = flash_.require_word(symbol->address);
}

}  // namespace proleg::sim
