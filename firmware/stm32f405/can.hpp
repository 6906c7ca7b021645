#pragma once

// The bxCAN controller CAN1 (RM0090, section 32) at 1 Mbit/s: eleven-bit data frames, three transmit mailboxes.
//
// The interrupts (CAN1_TX, CAN1_RX0, CAN1_SCE, all with the same priority) put each event into a ring, with its time.
// The module's program, at a lower priority, takes the events in their order, and sends. Two frames on a bus are 47 us
// apart or more, and no interrupt waits that long, so a received frame and a sent one never wait for their interrupts
// at the same time. (They can while flash is erased. Then the NVIC takes CAN1_TX first, which has the lower position,
// and the mailbox with the lowest number comes first. A module that erases is Pre-operational, where the order of
// frames has no effect.)

#include <array>
#include <atomic>

#include "firmware/stm32f405/event_ring.hpp"
#include "shared/can/can_port.hpp"

namespace proleg::stm32f405 {

class Can final : public CanPort {
 public:
  enum class EventKind : std::uint8_t { received, transmitted };

  struct Event {
    std::uint32_t stamp = 0;  ///< MicrosecondClock::stamp()
    CanFrame frame;           ///< the frame that was received or sent
    EventKind kind = EventKind::received;
  };

  /// Sets the controller up; it takes part in the bus after 11 recessive bits. False if it does not enter its
  /// initialization mode.
  [[nodiscard]] bool start();

  // Functions for the priority of the module's program.

  /// Sends a frame. The last mailbox takes only identifiers below 0x100. Also false if a mailbox holds a frame with
  /// this identifier, so that frames with the same identifier keep their order; and from bus-off until the controller
  /// is back.
  [[nodiscard]] bool send(const CanFrame& frame) override;
  void set_node(std::uint8_t node) override;
  void listen(std::span<const std::uint16_t> identifiers) override;
  void expect_heartbeat(std::uint8_t node) override;
  void receive_all(bool all) override;
#ifndef PROLEG_CAN_WITHOUT_ERROR_COUNTS  // the bootloader does not use them, and has no room for them
  [[nodiscard]] CanStatus status() override;
  /// The last one of the errors since the last call.
  [[nodiscard]] CanErrors take_errors() override;
#endif
  void recover() override;

  /// The oldest event; null if there is none. It stays until drop_event().
  [[nodiscard]] const Event* next_event() const { return events_.front(); }
  void drop_event() { events_.pop(); }

  /// Whether recover() is in progress. No interrupt reports its end: is_bus_off() must be polled.
  [[nodiscard]] bool recovering() const { return recovery_ != Recovery::none; }
  /// Whether the controller is bus-off, or recovers from it. Must be called whenever the module's program runs. It
  /// reads the controller's state, so no event can be lost; CAN1_SCE only makes the program run.
  [[nodiscard]] bool is_bus_off();

  /// Number of frames that were lost since start(), because the controller's FIFO or the ring was full.
  [[nodiscard]] std::uint32_t lost_frames() const { return lost_.load(std::memory_order_relaxed); }

  // Functions for the interrupts.
  void on_transmit_interrupt(std::uint32_t stamp);
  void on_receive_interrupt(std::uint32_t stamp);
  void on_status_interrupt();

 private:
  static constexpr unsigned mailbox_count = 3;

  enum class Recovery : std::uint8_t {
    none,
    entering,  ///< initialization mode is requested
    leaving,   ///< the end of initialization mode is requested: the controller waits for 128 times 11 recessive bits
  };

  void follow_recovery();
  void put(std::uint32_t stamp, EventKind kind, const CanFrame& frame);

  EventRing<Event, 64> events_;
  std::array<CanFrame, mailbox_count> mailboxes_{};            ///< the frames in the mailboxes
  std::array<std::atomic<bool>, mailbox_count> is_pending_{};  ///< set by send(), cleared by CAN1_TX
  std::atomic<bool> is_bus_off_{false};                        ///< also set by CAN1_SCE, cleared by follow_recovery()
  std::atomic<std::uint32_t> lost_{0};
  Recovery recovery_ = Recovery::none;
  /// Bits in FA1R of the banks that receive_all() and expect_heartbeat() use now.
  std::uint32_t other_banks_ = 0;
};

}  // namespace proleg::stm32f405
