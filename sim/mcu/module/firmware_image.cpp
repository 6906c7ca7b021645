#include "sim/mcu/module/firmware_image.hpp"

#include <algorithm>

#include "firmware/stm32f405/flash_layout.hpp"

namespace proleg::sim {
namespace {

namespace flash_layout = stm32f405::flash_layout;

constexpr const char* record_symbol = "proleg_tick_record";

}  // namespace

FirmwareImage::FirmwareImage(const std::filesystem::path& file) : file_(file), flash_(file) {
  const auto& symbols = flash_.elf().symbols();
  const auto symbol = std::ranges::find(symbols, record_symbol, &ElfImage::Symbol::name);
  if (symbol == symbols.end()) {
    throw ElfError(file.string() + ": found no symbol " + record_symbol +
                   ", expected the firmware of a joint module for this chip (firmware/stm32f405)");
  }
  flash_.require_vector_table(flash_layout::image_body);  // behind the start stub
  tick_record_ = flash_.require_word(symbol->address);
}

std::vector<std::uint8_t> FirmwareImage::image() const {
  constexpr std::uint8_t erased = 0xFF;
  std::vector<std::uint8_t> image;
  for (const ElfImage::Segment& segment : flash_.elf().segments()) {
    if (segment.load_address < flash_layout::slot_a) {
      continue;  // this is the start stub
    }
    const std::size_t offset = segment.load_address - flash_layout::slot_a;
    image.resize(std::max(image.size(), offset + segment.bytes.size()), erased);
    std::ranges::copy(segment.bytes, image.begin() + static_cast<std::ptrdiff_t>(offset));
  }
  return image;
}

}  // namespace proleg::sim
