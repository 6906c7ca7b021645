#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "sim/bus/bus.hpp"
#include "sim/mcu/peripherals/bxcan_receiver.hpp"
#include "sim/mcu/peripherals/bxcan_transmitter.hpp"
#include "sim/mcu/peripherals/register_block.hpp"

namespace proleg::sim {

/// CAN1 of the STM32F405: bxCAN as its program sees it (RM0090, section 32), on a controller of the simulated bus.
///
/// A chip computes ahead of the bus. What its program asks of the bus (to send, to withdraw, to join or to leave) is
/// pending until the bus has reached its true time: the caller that advances both looks at next_request() and calls
/// submit(). What the bus reports sets flags and interrupt lines at bus time, that is in the chip's next piece of work.
/// A frame that the program releases from a FIFO leaves it at once, even if a frame that the bus delivers later was on
/// the wire before.
///
/// It rejects (UnmodelledAccess) what the project's protocol does not use: remote frames, extended identifiers, time
/// triggered communication, CAN2; and what the manual forbids: reserved bits, registers that are write-protected in
/// that state, a bit rate that is not the bus's.
///
/// Simplified: MSR.RX and SAMP are always 1 (recessive); TXM and RXM show what the bus does at bus time. ALST is set
/// only with NART = 1 (with retransmission, a lost arbitration is no outcome). DBF is stored and has no effect. LBKM
/// without SILM: its frames go over the bus like those of others, and do not collide with frames that it ignores.
/// Between reset and the first initialisation mode it may leave sleep mode, but has no bit rate and receives nothing.
class BxCan final : public RegisterBlock, private BusListener {
 public:
  /// Interrupt lines.
  static constexpr unsigned tx_interrupt = 19;
  static constexpr unsigned rx0_interrupt = 20;
  static constexpr unsigned rx1_interrupt = 21;
  static constexpr unsigned sce_interrupt = 22;

  /// Returns the true time of a local time; it must not run backwards.
  using TrueTime = std::function<BusTime(LocalTime)>;

  /// Attaches to the bus; the controller is off. The arguments must outlive it, and it must outlive the bus's next
  /// event: the bus calls it.
  BxCan(ChipServices& chip, Bus& bus, TrueTime true_time);
  BxCan(const BxCan&) = delete;
  BxCan& operator=(const BxCan&) = delete;

  [[nodiscard]] std::string register_name(std::uint32_t offset) const override;
  [[nodiscard]] std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  /// Resets the registers, leaves the bus at once (a frame on the wire finishes) and drops all pending requests; also
  /// called for power off.
  void reset() override;
  /// Frames of the self-test (LBKM and SILM) end by the chip's own clock.
  [[nodiscard]] LocalTime next_event() const override { return self_test_end_; }
  void advance() override;
  /// Throws UnmodelledAccess if the clock of the controller changes while it is on the bus.
  void clocks_change(const Clocks& next) override;
  /// The controller leaves the bus until its next reset. (At a wrong bit rate it would disturb the frames of others.)
  void clocks_fail(const Clocks& next) override;
  [[nodiscard]] bool is_idle() const override;

  /// True time of the first pending request; never_on_bus if none is pending.
  [[nodiscard]] BusTime next_request() const { return requests_.next_time(); }
  /// Carries out the requests of times up to now, which must be Bus::now().
  void submit(BusTime now);

  /// Index of this peripheral's controller on the bus.
  [[nodiscard]] std::size_t controller() const { return controller_.index(); }

 private:
  enum class Mode : std::uint8_t { sleep, initialisation, normal };

  void received(BusTime time, const CanFrame& frame) override;
  void transmitted(BusTime time, const CanFrame& frame) override;
  void error_seen(BusTime time, bool was_sending) override;
  void error_state_changed(BusTime time) override;
  void joined(BusTime time) override;
  void frame_began(BusTime time) override;

  [[nodiscard]] std::uint32_t master_status() const;
  [[nodiscard]] std::uint32_t error_status() const;
  [[nodiscard]] std::uint32_t read_mailbox(std::uint32_t offset) const;
  void write_master_control(std::uint32_t value);
  void write_mailbox(std::uint32_t offset, std::uint32_t value);
  void write_bit_timing(std::uint32_t value);
  void require_bit_rate_of_bus() const;
  [[nodiscard]] LocalTime bit_period() const;

  /// Adds a request at the present time of the program.
  void ask(BxCanRequests::Kind kind, std::uint32_t value);
  /// Applies a new MCR, or postpones the request if a frame is on the wire.
  void apply_control(BusTime now, const BxCanRequests::Request& request);
  void enter(Mode mode);
  void leave_for_normal();
  void store(const CanFrame& frame);
  void start_self_test(LocalTime now);
  [[nodiscard]] bool is_self_test() const;
  void update_warning();
  void update_interrupts();

  Bus* bus_;
  TrueTime true_time_;
  Controller& controller_;
  BxCanTransmitter transmitter_;
  BxCanRequests requests_;

  Mode mode_ = Mode::sleep;
  bool is_leaving_ = false;  ///< it waits for 11 recessive bits; mode_ is still the one before
  bool has_failed_ = false;  ///< its clock has failed
  bool has_timing_ = false;  ///< BTR was written since reset
  std::uint32_t control_ = 0;
  std::uint32_t status_ = 0;  ///< MSR: ERRI, WKUI, SLAKI
  std::uint32_t interrupts_ = 0;
  std::uint32_t last_error_ = 0;
  std::uint32_t timing_ = 0;
  bool is_warning_ = false;
  std::array<BxCanFifo, 2> fifos_;
  BxCanFilters filters_;
  InterruptLine transmit_line_;
  std::array<InterruptLine, 2> fifo_lines_;
  InterruptLine status_line_;
  LocalTime self_test_end_ = never_on_chip;
  std::size_t self_test_mailbox_ = 0;
  LocalTime self_test_free_at_ = 0;
};

}  // namespace proleg::sim
