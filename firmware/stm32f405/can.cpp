#include "firmware/stm32f405/can.hpp"

#include <cstring>

#include "firmware/stm32f405/pins.hpp"
#include "firmware/stm32f405/registers/can.hpp"
#include "firmware/stm32f405/registers/rcc.hpp"
#include "shared/broadcast/transfer_frame.hpp"
#include "shared/canopen/messages.hpp"

namespace proleg::stm32f405 {
namespace {

// A bit has 14 quanta and is sampled after 12 of them: at 85.7 %. CiA 301 recommends 87.5 %, which 42 MHz cannot give:
// the divisors of 42 allow 6, 7, 14 and 21 quanta, and the first segment has at most 16 (81 % of 21).
constexpr std::uint32_t prescaler = 3;
constexpr std::uint32_t segment_1 = 11;
constexpr std::uint32_t segment_2 = 2;
constexpr std::uint32_t jump_width = 2;  // as much as segment_2 allows: edges may ring on a bus with many stubs
static_assert(board::apb1 / prescaler / (1 + segment_1 + segment_2) == 1'000'000);

/// Number of reads within which the controller enters initialization mode. It does so after the current frame: 135 bits
/// at most, and errors.
constexpr std::uint32_t reads_for_a_frame = 10'000;
/// Number of reads within which RFOM ends: it takes a few cycles of APB1.
constexpr unsigned reads_for_release = 16;
/// Number of frames that an interrupt handles: the FIFO holds three. If more frames come meanwhile, the interrupt comes
/// again.
constexpr unsigned frames_per_interrupt = 3;

/// The bits of TSR for a mailbox.
constexpr std::uint32_t of_mailbox(std::uint32_t bits_of_mailbox_0, unsigned mailbox) {
  return bits_of_mailbox_0 << (8U * mailbox);
}

// Filter banks, all in 16-bit scale and into FIFO 0. They pass data frames with 11-bit identifiers that concern the
// module: in a chain of 20 coupled joints two of the 19 state frames that the others send in a tick.
constexpr unsigned node_bank = 0;    ///< masks that pass the module's own identifiers
constexpr unsigned common_bank = 1;  ///< lists that pass messages for all nodes
/// Lists that pass the identifiers of the LSS master, of a host that sends an image, and of the host's heartbeat.
constexpr unsigned service_bank = 2;
constexpr unsigned first_list_bank = 3;  ///< lists that pass state frames that the joint depends on, four in each bank
/// Masks that pass all state frames, if the lists are too short.
constexpr unsigned all_states_bank = can1::filter_banks - 1;
/// Masks that pass every data frame, for the host of a gateway.
constexpr unsigned every_frame_bank = all_states_bank - 1;
/// Masks that pass the heartbeat of a node that is not the host, and that the module expects, or all heartbeats.
constexpr unsigned heartbeat_bank = every_frame_bank - 1;
constexpr unsigned list_banks = heartbeat_bank - first_list_bank;
constexpr std::size_t list_entries = 4;
constexpr std::uint32_t banks_of_every_robot = 1U << node_bank | 1U << common_bank | 1U << service_bank;

constexpr std::uint32_t filter_of(std::uint32_t identifier) { return identifier << can1::filter_stid_position; }
/// Identifier and mask of a filter: a frame passes if the bits of `mask` are equal.
constexpr std::uint32_t masked(std::uint32_t identifier, std::uint32_t mask) {
  return filter_of(identifier) | (filter_of(mask) | can1::filter_rtr | can1::filter_ide) << 16U;
}
constexpr std::uint32_t pair_of(std::uint32_t first, std::uint32_t second) {
  return filter_of(first) | filter_of(second) << 16U;
}

constexpr std::uint32_t function_bits = CanFrame::max_identifier & ~std::uint32_t{canopen::identifier::node_bits};

/// Lets frames to a node pass. A bank may be written while it is not in use. The module's own identifiers pass, so that
/// it notices another node that sends with them. Without a node id (0) they are common messages.
void accept_frames_of(std::uint8_t node) {
  namespace identifier = canopen::identifier;
  const can1::FilterBank own(node_bank);
  own.first.write(masked(node, identifier::node_bits));
  own.second.write(masked(node, identifier::node_bits));
}

/// Sets the filters that are the same in every robot.
void accept_common_frames() {
  namespace identifier = canopen::identifier;
  constexpr std::uint32_t with_masks =
      1U << node_bank | 1U << heartbeat_bank | 1U << all_states_bank | 1U << every_frame_bank;
  constexpr std::uint32_t all_banks = (1U << can1::filter_banks) - 1U;
  can1::fmr.change(can1::fmr_mask, can1::fmr_finit | can1::fmr_can2sb_of(can1::filter_banks));
  can1::fa1r.write(0);
  can1::fm1r.write(all_banks & ~with_masks);
  can1::fs1r.write(0);
  can1::ffa1r.write(0);
  accept_frames_of(0);
  const can1::FilterBank common(common_bank);
  common.first.write(pair_of(identifier::nmt, identifier::sync));
  common.second.write(pair_of(identifier::commit, identifier::tick));
  const can1::FilterBank services(service_bank);
  services.first.write(pair_of(identifier::lss_request, broadcast::host_identifier));
  constexpr std::uint32_t heartbeat_of_host = identifier::heartbeat + canopen::host_node;
  services.second.write(pair_of(heartbeat_of_host, heartbeat_of_host));
  const can1::FilterBank all_states(all_states_bank);
  all_states.first.write(masked(identifier::state_frame, function_bits));
  all_states.second.write(masked(identifier::second_state, function_bits));
  const can1::FilterBank every_frame(every_frame_bank);
  every_frame.first.write(masked(0, 0));
  every_frame.second.write(masked(0, 0));
  can1::fa1r.write(banks_of_every_robot);
  can1::fmr.clear(can1::fmr_finit);
}

/// A word of data without the bytes from `length` on, which the controller does not define.
constexpr std::uint32_t first_bytes(std::uint32_t word, std::uint32_t length) {
  return length >= 4 ? word : word & ((1U << (8U * length)) - 1U);
}

/// Reads the oldest frame of FIFO 0.
void read_frame(CanFrame& frame) {
  const std::uint32_t sent_length = can1::rdt0r.read() & can1::dtr_dlc;
  const std::uint32_t length = sent_length > CanFrame::max_length ? CanFrame::max_length : sent_length;
  const std::array<std::uint32_t, 2> words{first_bytes(can1::rdl0r.read(), length),
                                           length > 4 ? first_bytes(can1::rdh0r.read(), length - 4U) : 0U};
  frame.identifier = static_cast<std::uint16_t>(can1::ri0r.read() >> can1::ir_stid_position);
  frame.length = static_cast<std::uint8_t>(length);
  std::memcpy(frame.data.data(), words.data(), sizeof(words));  // the CPU and the registers are both little-endian
}

/// Aborts all frames at bus-off: pending frames would be out of date when the controller is back. CAN1_TX comes for
/// each aborted frame.
void abort_all() {
  can1::tsr.write(of_mailbox(can1::tsr_abrq0, 0) | of_mailbox(can1::tsr_abrq0, 1) | of_mailbox(can1::tsr_abrq0, 2));
}

}  // namespace

bool Can::start() {
  rcc::apb1enr.set(rcc::apb1enr_can1);
  static_cast<void>(rcc::apb1enr.read());
  // All options are off except DBF: time stamps, automatic return from bus-off and from sleep, locked FIFOs, sending in
  // the order of requests. A lower identifier goes first; a full FIFO loses its newest frame.
  can1::mcr.write(can1::mcr_dbf | can1::mcr_inrq);
  if (!wait_until_set(can1::msr, can1::msr_inak, reads_for_a_frame)) {
    return false;
  }
  can1::btr.write(can1::btr_of(prescaler, segment_1, segment_2, jump_width));
  accept_common_frames();
  can1::ier.write(can1::ier_tmeie | can1::ier_fmpie0 | can1::ier_fovie0 | can1::ier_bofie | can1::ier_errie);
  can1::mcr.write(can1::mcr_dbf);
  return true;
}

bool Can::send(const CanFrame& frame) {
  if (is_bus_off_.load(std::memory_order_relaxed)) {
    return false;
  }
  unsigned free = mailbox_count;
  const unsigned usable = frame.identifier < end_of_urgent_identifiers ? mailbox_count : mailbox_count - 1;
  for (unsigned mailbox = mailbox_count; mailbox-- > 0;) {
    if (!is_pending_[mailbox].load(std::memory_order_relaxed)) {
      free = mailbox < usable ? mailbox : free;
    } else if (mailboxes_[mailbox].identifier == frame.identifier) {
      return false;
    }
  }
  if (free == mailbox_count) {
    return false;
  }
  mailboxes_[free] = frame;
  is_pending_[free].store(true, std::memory_order_relaxed);
  std::array<std::uint32_t, 2> words{};
  std::memcpy(words.data(), frame.data.data(), sizeof(words));
  const can1::TransmitMailbox mailbox(free);
  mailbox.length.write(frame.length);
  mailbox.low.write(words[0]);
  mailbox.high.write(words[1]);
  std::atomic_signal_fence(std::memory_order_release);  // CAN1_TX may come from the next write on
  mailbox.identifier.write(std::uint32_t{frame.identifier} << can1::ir_stid_position | can1::tir_txrq);
  return true;
}

void Can::set_node(std::uint8_t node) {
  can1::fa1r.clear(1U << node_bank);
  accept_frames_of(node);
  can1::fa1r.set(1U << node_bank);
}

void Can::listen(std::span<const std::uint16_t> identifiers) {
  // A filter bank may be written while it is not in use.
  std::uint32_t used = banks_of_every_robot | other_banks_;
  can1::fa1r.write(used);
  if (identifiers.size() > list_banks * list_entries) {
    used |= 1U << all_states_bank;
  } else {
    // The rest of the last bank is filled with identifiers that pass anyway.
    const auto entry = [identifiers](std::size_t i) {
      return std::uint32_t{i < identifiers.size() ? identifiers[i] : canopen::identifier::sync};
    };
    for (std::size_t first = 0; first < identifiers.size(); first += list_entries) {
      const auto number = static_cast<unsigned>(first_list_bank + first / list_entries);
      const can1::FilterBank bank(number);
      bank.first.write(pair_of(entry(first), entry(first + 1)));
      bank.second.write(pair_of(entry(first + 2), entry(first + 3)));
      used |= 1U << number;
    }
  }
  can1::fa1r.write(used);
}

void Can::expect_heartbeat(std::uint8_t node) {
  constexpr std::uint32_t bit = 1U << heartbeat_bank;
  other_banks_ &= ~bit;
  can1::fa1r.clear(bit);
  if (node != 0 && node != canopen::host_node) {
    const std::uint32_t filter =
        node == every_node ? masked(canopen::identifier::heartbeat, function_bits)
                           : masked(canopen::identifier::heartbeat + std::uint32_t{node}, CanFrame::max_identifier);
    const can1::FilterBank bank(heartbeat_bank);
    bank.first.write(filter);
    bank.second.write(filter);
    other_banks_ |= bit;
    can1::fa1r.set(bit);
  }
}

void Can::receive_all(bool all) {
  constexpr std::uint32_t bit = 1U << every_frame_bank;
  other_banks_ = all ? other_banks_ | bit : other_banks_ & ~bit;
  can1::fa1r.change(bit, other_banks_);
}

#ifndef PROLEG_CAN_WITHOUT_ERROR_COUNTS

CanStatus Can::status() {
  const std::uint32_t value = can1::esr.read();
  CanStatus status;
  if ((value & can1::esr_boff) != 0 || is_bus_off_.load(std::memory_order_relaxed)) {
    status.state = CanState::bus_off;
  } else if ((value & can1::esr_epvf) != 0) {
    status.state = CanState::error_passive;
  } else if ((value & can1::esr_ewgf) != 0) {
    status.state = CanState::error_warning;
  }
  status.transmit_errors = static_cast<std::uint8_t>(value >> can1::esr_tec_position);
  status.receive_errors = static_cast<std::uint8_t>(value >> can1::esr_rec_position);
  return status;
}

CanErrors Can::take_errors() {
  const std::uint32_t kind = can1::esr.read() >> can1::esr_lec_position & can1::esr_lec_unchanged;
  can1::esr.write(can1::esr_lec_unchanged << can1::esr_lec_position);
  // Kinds of errors in the order of LEC, 1 to 6 (RM0090, section 32.9.2).
  constexpr std::array<CanErrorKind, 6> kinds{CanErrorKind::stuff,           CanErrorKind::form,
                                              CanErrorKind::acknowledgement, CanErrorKind::bit_recessive,
                                              CanErrorKind::bit_dominant,    CanErrorKind::crc};
  CanErrors errors;
  if (kind >= 1 && kind <= kinds.size()) {
    errors.add(kinds[kind - 1]);
  }
  return errors;
}

#endif

void Can::recover() {
  // This check is made even while an earlier request is in progress: the controller may have gone bus-off again since.
  if (is_bus_off_.load(std::memory_order_relaxed)) {
    abort_all();  // frames are aborted again, because bus-off may have come while send() ran
    can1::mcr.write(can1::mcr_dbf | can1::mcr_inrq);
    recovery_ = Recovery::entering;
  }
}

bool Can::is_bus_off() {
  if (recovery_ != Recovery::none) {
    follow_recovery();
  }
  if (can1::esr.has(can1::esr_boff)) {
    is_bus_off_.store(true, std::memory_order_relaxed);
  }
  return is_bus_off_.load(std::memory_order_relaxed);
}

void Can::follow_recovery() {
  const std::uint32_t is_initializing = can1::msr.read() & can1::msr_inak;
  if (recovery_ == Recovery::entering && is_initializing != 0) {
    can1::mcr.write(can1::mcr_dbf);
    recovery_ = Recovery::leaving;
  } else if (recovery_ == Recovery::leaving && is_initializing == 0 && !can1::esr.has(can1::esr_boff)) {
    recovery_ = Recovery::none;
    is_bus_off_.store(false, std::memory_order_relaxed);
  }
}

void Can::put(std::uint32_t stamp, EventKind kind, const CanFrame& frame) {
  if (Event* const event = events_.back()) {
    *event = {stamp, frame, kind};
    events_.push();
  } else {
    lost_.store(lost_.load(std::memory_order_relaxed) + 1U, std::memory_order_relaxed);
  }
}

void Can::on_transmit_interrupt(std::uint32_t stamp) {
  const std::uint32_t status = can1::tsr.read();
  for (unsigned mailbox = 0; mailbox < mailbox_count; ++mailbox) {
    if ((status & of_mailbox(can1::tsr_rqcp0, mailbox)) == 0) {
      continue;
    }
    can1::tsr.write(of_mailbox(can1::tsr_rqcp0, mailbox));
    if ((status & of_mailbox(can1::tsr_txok0, mailbox)) != 0) {  // else the frame was aborted
      put(stamp, EventKind::transmitted, mailboxes_[mailbox]);
    }
    is_pending_[mailbox].store(false, std::memory_order_relaxed);
  }
}

void Can::on_receive_interrupt(std::uint32_t stamp) {
  std::uint32_t status = can1::rf0r.read();
  for (unsigned i = 0; i < frames_per_interrupt; ++i) {
    if ((status & can1::rf0r_fovr) != 0) {
      can1::rf0r.write(can1::rf0r_fovr);
      lost_.store(lost_.load(std::memory_order_relaxed) + 1U, std::memory_order_relaxed);
    }
    if ((status & can1::rf0r_fmp) == 0) {
      return;
    }
    if (Event* const event = events_.back()) {
      event->stamp = stamp;
      event->kind = EventKind::received;
      read_frame(event->frame);
      events_.push();
    } else {
      lost_.store(lost_.load(std::memory_order_relaxed) + 1U, std::memory_order_relaxed);
    }
    can1::rf0r.write(can1::rf0r_rfom);
    // Until the release is done the same frame is still the oldest, and would raise the interrupt again.
    unsigned reads = reads_for_release;
    do {
      status = can1::rf0r.read();
    } while ((status & can1::rf0r_rfom) != 0 && --reads > 0);
  }
}

void Can::on_status_interrupt() {
  can1::msr.write(can1::msr_erri);
  if (can1::esr.has(can1::esr_boff)) {
    is_bus_off_.store(true, std::memory_order_relaxed);
    abort_all();
  }
}

}  // namespace proleg::stm32f405
