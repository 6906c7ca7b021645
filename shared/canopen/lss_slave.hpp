#pragma once

// The slave of the layer setting services (CiA 305): a master finds modules by their identity and gives them node ids.

#include <optional>

#include "shared/canopen/lss_frame.hpp"

namespace proleg::canopen {

/// Keeps the node id of the device behind an LSS slave.
class LssStorage {
 public:
  /// Result of storing: an error code of namespace `lss`, and the code that follows specific_error.
  struct Result {
    std::uint8_t error = lss::ok;
    std::uint8_t specific = 0;
  };
  [[nodiscard]] virtual Result store_node(std::uint8_t node) = 0;

 protected:
  ~LssStorage() = default;
};

/// A slave. Its state decides which services it answers: waiting, or selected for configuration.
class LssSlave {
 public:
  /// Starts the slave after power-on. node: the stored node id; 0: none.
  void power_on(std::uint8_t node) {
    pending_node_ = node;
    reset();
  }
  /// Returns to the state `waiting`. Must be called at every start of the communication.
  void reset();

  /// Handles a frame on 0x7E5. address: the module's own; node: the node id in use, 0: none. Returns the answer;
  /// nothing for a service without an answer, a frame for other slaves or a frame that is not one of LSS.
  [[nodiscard]] std::optional<CanFrame> serve(const CanFrame& request, const LssAddress& address, std::uint8_t node,
                                              LssStorage& storage);

  [[nodiscard]] lss::State state() const { return state_; }
  /// The node id that takes effect at the next start of the communication; 0: none.
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
  std::uint8_t selected_ = 0;    ///< numbers of the address, from the first on, that were selected in a row
  std::uint8_t identified_ = 0;  ///< conditions, from the first on, that held in a row
  std::uint8_t scanned_ = 0;     ///< position of the number that Fastscan asks for
};

}  // namespace proleg::canopen
