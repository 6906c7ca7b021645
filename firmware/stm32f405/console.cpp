#include "firmware/stm32f405/console.hpp"

#include <array>

#include "firmware/stm32f405/pins.hpp"
#include "firmware/stm32f405/registers/rcc.hpp"
#include "firmware/stm32f405/registers/usart.hpp"

namespace proleg::stm32f405 {
namespace {

constexpr std::uint32_t on = usart2::cr1_ue | usart2::cr1_te;

/// Number of reads in which a byte is sent. A byte takes 87 us; a read takes 5 cycles or more, at up to 168 MHz.
constexpr std::uint32_t reads_for_a_byte = 10'000;

}  // namespace

void Console::start(std::uint32_t peripheral_hz, std::uint32_t baud) {
  rcc::apb1enr.set(rcc::apb1enr_usart2);
  static_cast<void>(rcc::apb1enr.read());
  usart2::brr.write((peripheral_hz + baud / 2) / baud);
  usart2::cr1.write(on);
}

void Console::write(std::string_view text) {
  if (text.size() > pending_.room()) {
    return;
  }
  for (const char character : text) {
    *pending_.back() = character;
    pending_.push();
  }
  usart2::cr1.write(on | usart2::cr1_txeie);
}

void Console::write_hex(std::uint32_t value) {
  std::array<char, 8> digits{};
  for (std::size_t i = digits.size(); i-- > 0; value >>= 4U) {
    digits[i] = "0123456789abcdef"[value & 15U];
  }
  write({digits.data(), digits.size()});
}

void Console::write_decimal(std::uint32_t value) {
  std::array<char, 10> digits{};
  std::size_t first = digits.size();
  do {
    digits[--first] = static_cast<char>('0' + value % 10U);
    value /= 10U;
  } while (value != 0);
  write({&digits[first], digits.size() - first});
}

bool Console::is_idle() const { return pending_.front() == nullptr && usart2::sr.has(usart2::sr_tc); }

void Console::on_interrupt() {
  // A write takes some cycles to reach the peripheral. An interrupt that returns before comes again: without TXE, a
  // second write would replace the character that waits. Together with the write to DR, the read clears TC (RM0090,
  // section 30.6.1).
  if (!usart2::sr.has(usart2::sr_txe)) {
    return;
  }
  if (const char* const character = pending_.front()) {
    usart2::dr.write(static_cast<unsigned char>(*character));
    pending_.pop();
  } else {
    usart2::cr1.write(on);
  }
}

void Console::flush() {
  while (const char* const character = pending_.front()) {
    if (!wait_until_set(usart2::sr, usart2::sr_txe, reads_for_a_byte)) {
      return;
    }
    usart2::dr.write(static_cast<unsigned char>(*character));
    pending_.pop();
  }
}

}  // namespace proleg::stm32f405
