#include "sim/mcu/peripherals/usart.hpp"

#include <algorithm>
#include <string>

namespace proleg::sim {
namespace {

constexpr std::uint32_t sr = 0x00;
constexpr std::uint32_t dr = 0x04;
constexpr std::uint32_t brr = 0x08;
constexpr std::uint32_t cr1 = 0x0C;
constexpr std::uint32_t cr2 = 0x10;
constexpr std::uint32_t cr3 = 0x14;
constexpr std::uint32_t gtpr = 0x18;
constexpr RegisterName registers[] = {{sr, "SR"},   {dr, "DR"},   {brr, "BRR"},  {cr1, "CR1"},
                                      {cr2, "CR2"}, {cr3, "CR3"}, {gtpr, "GTPR"}};

constexpr std::uint32_t sr_fe = 1U << 1U;
constexpr std::uint32_t sr_ore = 1U << 3U;
constexpr std::uint32_t sr_idle = 1U << 4U;
constexpr std::uint32_t sr_rxne = 1U << 5U;
constexpr std::uint32_t sr_tc = 1U << 6U;
constexpr std::uint32_t sr_txe = 1U << 7U;

constexpr std::uint32_t cr1_sbk = 1U << 0U;
constexpr std::uint32_t cr1_rwu = 1U << 1U;
constexpr std::uint32_t cr1_re = 1U << 2U;
constexpr std::uint32_t cr1_te = 1U << 3U;
constexpr std::uint32_t cr1_idleie = 1U << 4U;
constexpr std::uint32_t cr1_rxneie = 1U << 5U;
constexpr std::uint32_t cr1_tcie = 1U << 6U;
constexpr std::uint32_t cr1_txeie = 1U << 7U;
constexpr std::uint32_t cr1_pce = 1U << 10U;
constexpr std::uint32_t cr1_m = 1U << 12U;
constexpr std::uint32_t cr1_ue = 1U << 13U;
constexpr std::uint32_t cr1_over8 = 1U << 15U;
constexpr std::uint32_t cr1_bits = 0xBFFF;

constexpr std::uint32_t cr2_rejected = 0x7840;  // LINEN, STOP, CLKEN, LBDIE
constexpr std::uint32_t cr2_bits = 0x7F6F;
constexpr std::uint32_t cr3_eie = 1U << 0U;
constexpr std::uint32_t cr3_dmar = 1U << 6U;
constexpr std::uint32_t cr3_dmat = 1U << 7U;
constexpr std::uint32_t cr3_refused = 0xF3E;

/// Flags that a read of SR and then of DR clears.
constexpr std::uint32_t receiver_flags = sr_fe | sr_ore | sr_idle;

// The channel and the streams of USART2 (RM0090, table 42).
constexpr unsigned dma_channel = 4;
constexpr unsigned receive_stream = 5;
constexpr unsigned transmit_stream = 6;

/// Clocks of the bus in a bit: USARTDIV times 16, or times 8 (RM0090, 30.3.4). Nothing for a USARTDIV below 1.
std::optional<std::uint32_t> clocks_of_bit(std::uint32_t divider, bool over8) {
  const std::uint32_t clocks = over8 ? (divider >> 4U) * 8 + (divider & 0x7U) : divider;
  return clocks >= (over8 ? 8U : 16U) ? std::optional(clocks) : std::nullopt;
}

}  // namespace

Usart::Usart(ChipServices& chip, BoardSignals& board, Dma* dma)
    : RegisterBlock(chip, "USART2", 0x4000'4400, 0x400, registers),
      board_(&board),
      dma_(dma),
      interrupt_(chip, interrupt_position) {
  if (dma_ != nullptr) {
    dma_->connect({receive_stream, dma_channel, Dma::Direction::from_peripheral, 1, base() + dr}, receive_request_);
    dma_->connect({transmit_stream, dma_channel, Dma::Direction::to_peripheral, 1, base() + dr}, transmit_request_);
  }
  Usart::reset();
}

bool Usart::TransmitRequest::requests_dma() const {
  constexpr std::uint32_t sending = cr1_ue | cr1_te;
  return (port.cr3_ & cr3_dmat) != 0 && (port.sr_ & sr_txe) != 0 && (port.cr1_ & sending) == sending;
}

bool Usart::ReceiveRequest::requests_dma() const { return (port.cr3_ & cr3_dmar) != 0 && (port.sr_ & sr_rxne) != 0; }

void Usart::reset() {
  sr_ = sr_txe | sr_tc;
  brr_ = 0;
  cr1_ = 0;
  cr2_ = 0;
  cr3_ = 0;
  gtpr_ = 0;
  received_ = 0;
  waiting_.reset();
  shifting_.reset();
  frame_end_ = never_on_chip;
  receiver_.reset();
  flags_read_ = 0;
  interrupt_.set(false);
}

std::optional<LocalTime> Usart::bit_time() const {
  const std::optional<std::uint32_t> clocks = clocks_of_bit(brr_, (cr1_ & cr1_over8) != 0);
  return clocks ? std::optional(*clocks * chip().clocks().apb1) : std::nullopt;
}

LocalTime Usart::frame_time() const { return serial_character_bits * *bit_time(); }

LocalTime Usart::next_event() const {
  return receives() ? std::min(frame_end_, receiver_.next_event(*bit_time())) : frame_end_;
}

void Usart::advance() { settle(); }

bool Usart::is_idle() const { return !sends() && !receives(); }

bool Usart::receives() const { return (cr1_ & (cr1_ue | cr1_re)) == (cr1_ue | cr1_re); }

void Usart::settle() {
  settle_transmitter();
  settle_receiver();
  update_interrupt();
}

void Usart::settle_transmitter() {
  while (frame_end_ <= chip().now()) {
    const std::optional<std::uint8_t> sent = shifting_;
    const LocalTime end = frame_end_;
    shifting_ = waiting_;
    waiting_.reset();
    if (shifting_) {
      frame_end_ += frame_time();
      sr_ |= sr_txe;
    } else {
      frame_end_ = never_on_chip;
      sr_ |= sr_tc;
    }
    if (sent) {
      board_->serial_output(number, *sent);
      if (output_watch_) {
        output_watch_(end, *sent);
      }
    }
    serve_dma();
  }
}

void Usart::settle_receiver() {
  if (!receives()) {
    return;
  }
  while (const auto event = receiver_.take(chip().now(), *bit_time())) {
    if (event->kind == SerialReceiver::Kind::idle) {
      sr_ |= sr_idle;
    } else {
      take_character(event->character);
    }
  }
}

void Usart::take_character(const SerialCharacter& character) {
  if ((sr_ & sr_rxne) != 0) {
    sr_ |= sr_ore;  // the new byte is lost
    return;
  }
  received_ = character.byte;
  sr_ |= sr_rxne | (character.has_stop_bit ? 0U : sr_fe);
  serve_dma();
}

void Usart::serve_dma() {
  if (dma_ != nullptr) {
    dma_->serve(receive_stream);
    dma_->serve(transmit_stream);
  }
}

void Usart::begin_receive(LocalTime start, const SerialCharacter& character, LocalTime bit) {
  settle();
  if (receives()) {
    receiver_.begin(start, character, bit);
    chip().reschedule();
  }
}

void Usart::update_interrupt() {
  const bool transmit =
      ((sr_ & sr_txe) != 0 && (cr1_ & cr1_txeie) != 0) || ((sr_ & sr_tc) != 0 && (cr1_ & cr1_tcie) != 0);
  const bool receive = ((sr_ & (sr_rxne | sr_ore)) != 0 && (cr1_ & cr1_rxneie) != 0) ||
                       ((sr_ & sr_idle) != 0 && (cr1_ & cr1_idleie) != 0);
  // EIE acts with DMA only (RM0090, 30.6.6).
  constexpr std::uint32_t reported = cr3_eie | cr3_dmar;
  const bool error = (sr_ & (sr_fe | sr_ore)) != 0 && (cr3_ & reported) == reported;
  interrupt_.set(transmit || receive || error);
}

void Usart::clocks_change(const Clocks& next) {
  settle();
  if (sends() && next.apb1 != chip().clocks().apb1) {
    throw UnmodelledAccess("USART2 is sending while PCLK1 changes");
  }
}

void Usart::clocks_fail(const Clocks& /*next*/) {
  settle();
  shifting_.reset();
  waiting_.reset();
  receiver_.reset();
  frame_end_ = never_on_chip;
}

std::uint32_t Usart::read(std::uint32_t offset) {
  settle();
  switch (offset) {
    case sr:
      flags_read_ |= sr_ & (sr_tc | receiver_flags);
      return sr_;
    case dr:
      return take_data();
    case brr:
      return brr_;
    case cr1:
      return cr1_;
    case cr2:
      return cr2_;
    case cr3:
      return cr3_;
    case gtpr:
      return gtpr_;
    default:
      reject_read(offset);
  }
}

void Usart::write(std::uint32_t offset, std::uint32_t value) {
  settle();
  switch (offset) {
    case sr:
      sr_ &= value | ~(sr_tc | sr_rxne);
      break;
    case dr:
      write_data(value);
      break;
    case brr:
      write_brr(value);
      break;
    case cr1:
      write_cr1(value);
      break;
    case cr2:
      reject_bits(offset, value, cr2_rejected, "only asynchronous frames with one stop bit are modelled");
      cr2_ = value & cr2_bits;
      break;
    case cr3:
      write_cr3(value);
      break;
    case gtpr:
      gtpr_ = value & 0xFFFFU;
      break;
    default:
      reject_write(offset, value);
  }
  update_interrupt();
}

void Usart::check_divider(std::uint32_t divider, bool over8, std::uint32_t offset, std::uint32_t value) const {
  if (!clocks_of_bit(divider, over8)) {
    reject_write(offset, value, "USARTDIV is below 1");
  }
  if (over8 && bit(divider, 3)) {
    reject_write(offset, value, "bit 3 of USART2_BRR must be clear with OVER8");
  }
}

void Usart::write_brr(std::uint32_t value) {
  const std::uint32_t next = value & 0xFFFFU;
  if (sends()) {
    reject_write(brr, value, "the baud rate changes while a byte is being sent");
  }
  if ((cr1_ & cr1_ue) != 0) {
    check_divider(next, (cr1_ & cr1_over8) != 0, brr, value);
  }
  brr_ = next;
}

void Usart::write_cr1(std::uint32_t value) {
  reject_bits(cr1, value, cr1_sbk | cr1_rwu, "break and mute mode are not modelled");
  reject_bits(cr1, value, cr1_pce | cr1_m, "only 8 data bits without parity are modelled");
  const std::uint32_t next = value & cr1_bits;
  constexpr std::uint32_t sending = cr1_ue | cr1_te;
  const bool could_send = (cr1_ & sending) == sending;
  const bool can_send = (next & sending) == sending;
  if (sends() && (!can_send || ((next ^ cr1_) & cr1_over8) != 0)) {
    reject_write(cr1, value, "UE, TE or OVER8 changes while a byte is being sent");
  }
  if ((next & cr1_ue) != 0 && (next & (cr1_te | cr1_re)) != 0) {
    check_divider(brr_, (next & cr1_over8) != 0, cr1, value);
  }
  cr1_ = next;
  if (can_send && !could_send) {
    // The transmitter begins with an idle frame (RM0090, 30.3.2).
    shifting_.reset();
    frame_end_ = chip().now() + frame_time();
  }
  if (!receives()) {
    receiver_.reset();
  }
  serve_dma();
}

void Usart::write_cr3(std::uint32_t value) {
  reject_bits(cr3, value, cr3_refused, "flow control, half duplex, IrDA and smartcards are not modelled");
  if (dma_ == nullptr) {
    reject_bits(cr3, value, cr3_dmar | cr3_dmat, "DMA is not modelled here");
  }
  cr3_ = value & (cr3_eie | cr3_dmar | cr3_dmat);
  serve_dma();
}

void Usart::write_data(std::uint32_t value) {
  constexpr std::uint32_t sending = cr1_ue | cr1_te;
  if ((cr1_ & sending) != sending) {
    reject_write(dr, value, "UE or TE is off");
  }
  put_data(static_cast<std::uint8_t>(value));
}

void Usart::put_data(std::uint8_t byte) {
  sr_ &= ~(flags_read_ & sr_tc);
  flags_read_ &= ~sr_tc;
  if (sends()) {
    waiting_ = byte;  // replaces a byte that waits
    sr_ &= ~sr_txe;
  } else {
    shifting_ = byte;
    frame_end_ = chip().now() + frame_time();
    chip().reschedule();
  }
}

std::uint8_t Usart::take_data() {
  sr_ &= ~(sr_rxne | (flags_read_ & receiver_flags));
  flags_read_ &= sr_tc;
  update_interrupt();
  return received_;
}

}  // namespace proleg::sim
