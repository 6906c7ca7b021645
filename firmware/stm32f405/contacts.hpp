#pragma once

#include "firmware/module/ports.hpp"

namespace proleg::stm32f405 {

/// The four touch inputs as they are now; start_pins() configures them. A closed switch is a contact.
class Contacts final : public firmware::ContactPort {
 public:
  [[nodiscard]] std::uint8_t read() override;
};

}  // namespace proleg::stm32f405
