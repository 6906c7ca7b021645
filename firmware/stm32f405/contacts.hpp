#pragma once

#include "firmware/module/ports.hpp"

namespace proleg::stm32f405 {

/// Reads the four touch inputs, which start_pins() configures. A closed switch is a contact.
class Contacts final : public firmware::ContactPort {
 public:
  [[nodiscard]] std::uint8_t read() override;
};

}  // namespace proleg::stm32f405
