#include "sim/mcu/cpu/flash_image.hpp"

#include <elf.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string>

#include "shared/computer/text/text.hpp"
#include "sim/mcu/cpu/cpu_surroundings.hpp"

namespace proleg::sim {
namespace {

// Tags and values of build attributes (Addenda to the ABI for the Arm Architecture, 3.3).
constexpr std::uint32_t tag_file = 1;
constexpr std::uint32_t tag_cpu_arch = 6;
constexpr std::uint32_t tag_cpu_arch_profile = 7;
constexpr std::uint32_t tag_vfp_args = 28;
constexpr std::uint32_t arch_v7 = 10;
constexpr std::uint32_t arch_v6_m = 11;
constexpr std::uint32_t arch_v6s_m = 12;
constexpr std::uint32_t arch_v7e_m = 13;
constexpr std::uint32_t vfp_args_in_fpu = 1;

[[noreturn]] void refuse(const ElfImage& image, const std::string& found, const std::string& expected) {
  throw ElfError(image.file().string() + ": found " + found + ", expected " + expected);
}

/// Reads numbers off the attributes; at their end, zeros.
class AttributeReader {
 public:
  explicit AttributeReader(const std::vector<std::uint8_t>& bytes) : bytes_(bytes) {}

  [[nodiscard]] bool is_at_end() const { return place_ >= bytes_.size(); }
  std::uint8_t byte() { return is_at_end() ? std::uint8_t{0} : bytes_[place_++]; }
  std::uint32_t word() {
    std::uint32_t value = 0;
    for (unsigned i = 0; i < 4; ++i) {
      value |= std::uint32_t{byte()} << 8U * i;
    }
    return value;
  }
  std::uint32_t uleb128() {
    std::uint32_t value = 0;
    for (unsigned shift = 0; !is_at_end(); shift += 7) {
      const std::uint8_t next = byte();
      if (shift < 32) {
        value |= std::uint32_t{next & 0x7FU} << shift;
      }
      if ((next & 0x80U) == 0) {
        break;
      }
    }
    return value;
  }
  std::string text() {
    std::string text;
    while (!is_at_end()) {
      const std::uint8_t next = byte();
      if (next == 0) {
        break;
      }
      text.push_back(static_cast<char>(next));
    }
    return text;
  }

 private:
  const std::vector<std::uint8_t>& bytes_;
  std::size_t place_ = 0;
};

/// Reads the build attributes of the whole file whose values are numbers.
std::map<std::uint32_t, std::uint32_t> read_attributes(const std::vector<std::uint8_t>& bytes) {
  std::map<std::uint32_t, std::uint32_t> attributes;
  AttributeReader reader(bytes);
  if (reader.byte() != 'A') {
    return attributes;
  }
  static_cast<void>(reader.word());
  if (reader.text() != "aeabi" || reader.uleb128() != tag_file) {
    return attributes;
  }
  static_cast<void>(reader.word());
  while (!reader.is_at_end()) {
    const std::uint32_t tag = reader.uleb128();
    // CPU_raw_name, CPU_name, and above 32 all odd ones are texts; 32 is a number and a text.
    const bool is_text = tag == 4 || tag == 5 || (tag > 32 && tag % 2 == 1);
    if (is_text) {
      static_cast<void>(reader.text());
      continue;
    }
    attributes[tag] = reader.uleb128();
    if (tag == 32) {
      static_cast<void>(reader.text());
    }
  }
  return attributes;
}

void check_processor(const ElfImage& image) {
  const std::map<std::uint32_t, std::uint32_t> attributes = read_attributes(image.attributes());
  const auto value = [&](std::uint32_t tag) -> std::optional<std::uint32_t> {
    const auto found = attributes.find(tag);
    return found == attributes.end() ? std::nullopt : std::optional(found->second);
  };
  if (const auto arch = value(tag_cpu_arch)) {
    const bool is_microcontroller = value(tag_cpu_arch_profile).value_or(0) == 'M';
    if (*arch != arch_v6_m && *arch != arch_v6s_m && *arch != arch_v7e_m && !(*arch == arch_v7 && is_microcontroller)) {
      refuse(image, "a program for architecture " + std::to_string(*arch) + (is_microcontroller ? ", profile M" : ""),
             "one for a Cortex-M4 (ARMv7E-M, 13, or what it executes: 10 with profile M, 11, 12)");
    }
  }
  if ((image.flags() & EF_ARM_ABI_FLOAT_HARD) != 0 || value(tag_vfp_args) == vfp_args_in_fpu) {
    refuse(image, "a program that passes arguments in the FPU", "one compiled with -mfloat-abi=soft");
  }
}

void check_segments(const ElfImage& image) {
  if (image.segments().empty()) {
    refuse(image, "nothing to load", "a program for the flash at " + hexadecimal(ChipMemory::flash_start));
  }
  std::vector<const ElfImage::Segment*> sorted;
  for (const ElfImage::Segment& segment : image.segments()) {
    const std::uint64_t end = std::uint64_t{segment.load_address} + segment.bytes.size();
    if (segment.load_address < ChipMemory::flash_start ||
        segment.load_address >= ChipMemory::flash_start + ChipMemory::flash_size) {
      refuse(image, "a segment at " + hexadecimal(segment.load_address) + ", a program for another chip",
             "all of it in the flash at " + hexadecimal(ChipMemory::flash_start));
    }
    if (end > ChipMemory::flash_start + ChipMemory::flash_size) {
      refuse(image,
             "a segment at " + hexadecimal(segment.load_address) + " of " + std::to_string(segment.bytes.size()) +
                 " bytes",
             "at most " + std::to_string(ChipMemory::flash_size) + " bytes from " +
                 hexadecimal(ChipMemory::flash_start) + " on");
    }
    sorted.push_back(&segment);
  }
  std::ranges::sort(sorted, {}, &ElfImage::Segment::load_address);
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    if (sorted[i]->load_address - sorted[i - 1]->load_address < sorted[i - 1]->bytes.size()) {
      refuse(image,
             "segments at " + hexadecimal(sorted[i - 1]->load_address) + " and " +
                 hexadecimal(sorted[i]->load_address) + " that overlap",
             "each address once");
    }
  }
}

/// The word at an address, if the program has one there.
std::optional<std::uint32_t> word_at(const ElfImage& image, std::uint32_t address) {
  std::uint32_t word = 0;
  for (std::uint32_t i = 0; i < 4; ++i) {
    const auto segment = std::ranges::find_if(image.segments(), [&](const ElfImage::Segment& each) {
      return address + i >= each.load_address && address + i - each.load_address < each.bytes.size();
    });
    if (segment == image.segments().end()) {
      return std::nullopt;
    }
    word |= std::uint32_t{segment->bytes[address + i - segment->load_address]} << 8U * i;
  }
  return word;
}

void check_vector_table(const ElfImage& image, std::uint32_t address) {
  const auto stack = word_at(image, address);
  const auto start = word_at(image, address + 4);
  if (!stack || !start) {
    refuse(image, "nothing at " + hexadecimal(address), "the vector table");
  }
  const auto is_end_of = [&](std::uint32_t memory, std::uint32_t size) {
    return *stack > memory && *stack <= memory + size;
  };
  if (*stack % 4 != 0 || !(is_end_of(ChipMemory::ram_start, ChipMemory::ram_size) ||
                           is_end_of(ChipMemory::ccm_start, ChipMemory::ccm_size))) {
    refuse(image,
           "a vector table at " + hexadecimal(address) + " with the initial stack pointer " + hexadecimal(*stack),
           "a multiple of 4 within RAM (" + hexadecimal(ChipMemory::ram_start) + ") or core-coupled memory (" +
               hexadecimal(ChipMemory::ccm_start) + ")");
  }
  if (*start % 2 == 0 || !word_at(image, (*start & ~3U))) {
    refuse(image, "a vector table at " + hexadecimal(address) + " with the start address " + hexadecimal(*start),
           "an odd address (Thumb code) within the program");
  }
}

}  // namespace

FlashImage::FlashImage(const std::filesystem::path& file) : elf_(file) {
  check_processor(elf_);
  check_segments(elf_);
  require_vector_table(ChipMemory::flash_start);
}

void FlashImage::require_vector_table(std::uint32_t address) const { check_vector_table(elf_, address); }

std::uint32_t FlashImage::require_word(std::uint32_t address) const {
  const std::optional<std::uint32_t> word = word_at(elf_, address);
  if (!word) {
    refuse(elf_, "nothing at " + hexadecimal(address), "a word of the program");
  }
  return *word;
}

}  // namespace proleg::sim
