#include "host/flash/bare_failure.hpp"

#include <span>

#include "shared/computer/text/text.hpp"

namespace proleg::host {
namespace {

/// A text that a program prints, in the version of Debian 12, and its meaning.
struct Symptom {
  std::string_view text;
  std::string_view meaning;
};

constexpr std::string_view udev_hint = "host/udev/70-proleg.rules gives them to you; the file says how to install it";

// The first symptom that fits counts: causes are listed before their consequences.
constexpr Symptom openocd_symptoms[] = {
    {"LIBUSB_ERROR_ACCESS", "found an ST-LINK without the rights to open it, expected rights: "},
    {"LIBUSB_ERROR_BUSY", "found an ST-LINK that another program uses, expected a free one: close it"},
    {"Error: open failed", "found no ST-LINK, expected one on USB: plug it in, 'lsusb -d 0483:' lists it"},
    {"target voltage may be too low",
     "found a chip without supply voltage, expected 3.3 V: connect the board's supply"},
    {"unable to connect to the target",
     "found an ST-LINK without a chip, expected an STM32F405 behind it: check SWDIO, SWCLK, ground, and the board's "
     "supply"},
    {"stm32x device protected",
     "found a sector that is write-protected, expected at most sector 0 to be: 'flash protect' of openocd shows how"},
    {"contents differ", "found other bytes in the flash than were written, expected the same: check supply and wires"},
};

constexpr Symptom dfu_symptoms[] = {
    {"LIBUSB_ERROR_ACCESS", "found a DFU device without the rights to open it, expected rights: "},
    {"More than one DFU capable", "found several DFU devices, expected one: pull the plugs of the others"},
    {"No DFU capable USB device",
     "found no DFU device, expected an STM32F405 on USB: set BOOT0 to high, reset the board, 'lsusb -d 0483:df11' "
     "lists "
     "it"},
    {"status(11)",
     "found a chip whose read protection is on, expected none: 'proleg flash --bare --probe stlink' says more"},
};

constexpr Symptom uart_symptoms[] = {
    {"Failed to open port", "found a serial line that cannot be used, expected a UART: another program may use it"},
    {"Failed to init device",
     "found no answer on the line, expected the ROM bootloader: set BOOT0 to high, reset the board, check the wires"},
    {"Failed to read memory",
     "found a chip whose read protection is on, expected none: 'proleg flash --bare --probe stlink' says more"},
};

std::span<const Symptom> symptoms_of(BareProbe probe) {
  switch (probe) {
    case BareProbe::dfu:
      return dfu_symptoms;
    case BareProbe::uart:
      return uart_symptoms;
    case BareProbe::stlink:
      break;
  }
  return openocd_symptoms;
}

constexpr std::string_view repeat_hint = "; the command can be repeated";

std::string_view protection_hint(const BareStep& step) {
  return step.is_for_other_bootloader ? "; if sector 0 is write-protected, flash with --probe stlink" : "";
}

}  // namespace

std::string missing_program(const std::string& program) {
  return "found no program " + program + ", expected the Debian package of that name: 'sudo apt install " + program +
         "' installs it";
}

std::string bare_failure(const BarePlan& plan, const BareStep& step, std::string_view output) {
  // The beginning of a line that bare_script() prints.
  constexpr std::string_view refused = "refused: ";
  if (const std::size_t at = output.find(refused); at != std::string_view::npos) {
    const std::string_view rest = output.substr(at + refused.size());
    return std::string(rest.substr(0, rest.find('\n')));
  }
  std::string text = "found an error of " + step.command.front() + " in the step '" + step.what +
                     "', expected none: its last lines say more";
  for (const Symptom& symptom : symptoms_of(plan.probe)) {
    if (output.find(symptom.text) != std::string_view::npos) {
      text = symptom.meaning;
      text += text.ends_with(": ") ? udev_hint : "";
      break;
    }
  }
  return text.append(protection_hint(step)).append(repeat_hint);
}

std::string bare_difference(const BareStep& step) {
  std::string text = "found other bytes in the step '" + step.what + "' than were written, expected the same";
  return text.append(protection_hint(step)).append(repeat_hint);
}

}  // namespace proleg::host
