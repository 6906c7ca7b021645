#include "sim/mcu/peripherals/gpio.hpp"

#include <stdexcept>
#include <string>

namespace proleg::sim {
namespace {

constexpr std::uint32_t moder = 0x00;
constexpr std::uint32_t otyper = 0x04;
constexpr std::uint32_t ospeedr = 0x08;
constexpr std::uint32_t pupdr = 0x0C;
constexpr std::uint32_t idr = 0x10;
constexpr std::uint32_t odr = 0x14;
constexpr std::uint32_t bsrr = 0x18;
constexpr std::uint32_t lckr = 0x1C;
constexpr std::uint32_t afrl = 0x20;
constexpr std::uint32_t afrh = 0x24;
constexpr RegisterName registers[] = {{moder, "MODER"}, {otyper, "OTYPER"}, {ospeedr, "OSPEEDR"}, {pupdr, "PUPDR"},
                                      {idr, "IDR"},     {odr, "ODR"},       {bsrr, "BSRR"},       {lckr, "LCKR"},
                                      {afrl, "AFRL"},   {afrh, "AFRH"}};

constexpr std::string_view names[] = {"GPIOA", "GPIOB", "GPIOC", "GPIOD", "GPIOE", "GPIOF", "GPIOG", "GPIOH", "GPIOI"};

unsigned index_of(char port) {
  if (port < 'A' || port > 'I') {
    throw std::invalid_argument(std::string("port ") + port + ": expected A to I");
  }
  return static_cast<unsigned>(port - 'A');
}

enum Pull : std::uint8_t { none = 0, up = 1, down = 2, reserved = 3 };

}  // namespace

Gpio::Gpio(ChipServices& chip, BoardSignals& board, char port)
    : RegisterBlock(chip, names[index_of(port)], 0x4002'0000 + 0x400 * index_of(port), 0x400, registers),
      board_(&board),
      port_(port) {
  reset();
}

// After reset the pins of the debug port on A and B have their alternate functions.
void Gpio::reset() {
  moder_ = port_ == 'A' ? 0xA800'0000 : port_ == 'B' ? 0x0000'0280 : 0;
  otyper_ = 0;
  ospeedr_ = port_ == 'A' ? 0x0C00'0000 : port_ == 'B' ? 0x0000'00C0 : 0;
  pupdr_ = port_ == 'A' ? 0x6400'0000 : port_ == 'B' ? 0x0000'0100 : 0;
  odr_ = 0;
  afr_ = {};
}

Gpio::Mode Gpio::mode(unsigned pin) const { return static_cast<Mode>(field(moder_, 2 * pin, 2)); }

unsigned Gpio::alternate_function(unsigned pin) const { return field(afr_[pin / 8], 4 * (pin % 8), 4); }

unsigned Gpio::output_speed(unsigned pin) const { return field(ospeedr_, 2 * pin, 2); }

std::optional<bool> Gpio::output(unsigned pin) const {
  const bool high = bit(odr_, pin);
  if (mode(pin) != Mode::output || (bit(otyper_, pin) && high)) {
    return std::nullopt;
  }
  return high;
}

bool Gpio::level(unsigned pin) {
  if (mode(pin) == Mode::analog) {
    return false;
  }
  if (const std::optional<bool> own = output(pin)) {
    return *own;
  }
  if (mode(pin) == Mode::alternate && alternate_output_) {
    if (const std::optional<bool> driven = alternate_output_(pin)) {
      return *driven;
    }
  }
  return board_->pin(port_, pin).value_or(field(pupdr_, 2 * pin, 2) == Pull::up);
}

std::uint32_t Gpio::read(std::uint32_t offset) {
  switch (offset) {
    case moder:
      return moder_;
    case otyper:
      return otyper_;
    case ospeedr:
      return ospeedr_;
    case pupdr:
      return pupdr_;
    case idr: {
      std::uint32_t levels = 0;
      for (unsigned pin = 0; pin < pin_count; ++pin) {
        levels |= std::uint32_t{level(pin)} << pin;
      }
      return levels;
    }
    case odr:
      return odr_;
    case bsrr:  // write only
    case lckr:  // never locked
      return 0;
    case afrl:
      return afr_[0];
    case afrh:
      return afr_[1];
    default:
      reject_read(offset);
  }
}

void Gpio::write(std::uint32_t offset, std::uint32_t value) {
  constexpr std::uint32_t pins = 0xFFFF;
  switch (offset) {
    case moder:
      moder_ = value;
      break;
    case otyper:
      otyper_ = value & pins;
      break;
    case ospeedr:
      ospeedr_ = value;
      break;
    case pupdr:
      for (unsigned pin = 0; pin < pin_count; ++pin) {
        if (field(value, 2 * pin, 2) == Pull::reserved) {
          reject_write(offset, value, "11 for pin " + std::to_string(pin) + " is reserved");
        }
      }
      pupdr_ = value;
      break;
    case idr:
      break;  // read only
    case odr:
      odr_ = value & pins;
      break;
    case bsrr:
      // Setting has precedence over resetting.
      odr_ = (odr_ & ~(value >> 16U)) | (value & pins);
      break;
    case lckr:
      reject_write(offset, value, "locking is not modelled");
    case afrl:
      afr_[0] = value;
      break;
    case afrh:
      afr_[1] = value;
      break;
    default:
      reject_write(offset, value);
  }
}

}  // namespace proleg::sim
