#pragma once

// The slave of the layer setting services (CiA 305): a master finds modules by their identity and gives them node ids.

#include <optional>

#include "shared/canopen/lss_frame.hpp"

namespace proleg::canopen {

/// Keeps the node id of the device behind an LSS slave.
class LssStorage {
 public:
  /// node: 0: none. Returns an error code of namespace `lss` and, for specific_error, the code that follows it.
  struct Result {
    std::uint8_t error = lss::ok;
    std::uint8_t specific = 0;
  };
  [[nodiscard]] virtual Result store_node(std::uint8_t node) = 0;

 protected:
  ~LssStorage() = default;
};

/// Which services are answered depends on the slave's state: waiting, or selected for configuration.
class LssSlave {
 public:
  /// After power on. node: the stored node id, 0: none.
  void power_on(std::uint8_t node) {
    pending_node_ = node;
    reset();
  }
  /// At every start of the communication: waiting.
  void reset();

  /// Handles a frame on 0x7E5. address: the module's own; node: the node id in use, 0: none. Returns the answer;
  /// nothing for a service that has none, a frame for other slaves or one that is not of LSS.
  [[nodiscard]] std::optional<CanFrame> serve(const CanFrame& request, const LssAddress& address, std::uint8_t node,
                                              LssStorage& storage);

  [[nodiscard]] lss::State state() const { return state_; }
  /// The node id that the next start of the communication puts into use; 0: none.
  [[nodiscard]] std::uint8_t pending_node() const { return pending_node_; }

 private:
  [[nodiscard]] std::optional<CanFrame> configure(const CanFrame& request, const LssAddress& address, std::uint8_t node,
                                                  LssStorage& storage);
  [[nodiscard]] bool select(unsigned position, std::uint32_t number, const LssAddress& address);
  [[nodiscard]] bool identify(unsigned position, std::uint32_t number, const LssAddress& address);
  [[nodiscard]] bool scan(const lss::FastscanRequest& request, const LssAddress& address);
  [[nodiscard]] std::uint8_t set_node(std::uint8_t node);

  lss::State state_ = lss::State::waiting;
  std::uint8_t pending_node_ = 0;
  std::uint8_t selected_ = 0;    ///< numbers of the address that were selected in a row, from the first
  std::uint8_t identified_ = 0;  ///< conditions that held in a row, from the first
  std::uint8_t scanned_ = 0;     ///< the number that Fastscan asks for
};

}  // namespace proleg::canopen
