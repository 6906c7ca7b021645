#include "sim/mcu/peripherals/bxcan.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "sim/bus/frame_bits.hpp"

namespace proleg::sim {
namespace {

enum Offset : std::uint32_t {
  mcr = 0x00,
  msr = 0x04,
  tsr = 0x08,
  rf0r = 0x0C,
  rf1r = 0x10,
  ier = 0x14,
  esr = 0x18,
  btr = 0x1C,
  first_transmit_mailbox = 0x180,
  first_receive_mailbox = 0x1B0,
  end_of_mailboxes = 0x1D0,
};

enum MasterControl : std::uint32_t {
  inrq = 1U << 0U,
  sleep = 1U << 1U,
  txfp = 1U << 2U,
  rflm = 1U << 3U,
  nart = 1U << 4U,
  awum = 1U << 5U,
  abom = 1U << 6U,
  ttcm = 1U << 7U,
  software_reset = 1U << 15U,
  dbf = 1U << 16U,
};
constexpr std::uint32_t control_after_reset = dbf | sleep;

enum MasterStatus : std::uint32_t {
  inak = 1U << 0U,
  slak = 1U << 1U,
  erri = 1U << 2U,
  wkui = 1U << 3U,
  slaki = 1U << 4U,
  txm = 1U << 8U,
  rxm = 1U << 9U,
  samp = 1U << 10U,
  rx = 1U << 11U,
};

enum InterruptEnable : std::uint32_t {
  tmeie = 1U << 0U,
  fmpie0 = 1U << 1U,  ///< FFIE0, FOVIE0, FMPIE1, FFIE1 and FOVIE1 follow
  ewgie = 1U << 8U,
  epvie = 1U << 9U,
  bofie = 1U << 10U,
  lecie = 1U << 11U,
  errie = 1U << 15U,
  wkuie = 1U << 16U,
  slkie = 1U << 17U,
};
constexpr std::uint32_t all_interrupts = 0x0003'8F7F;

enum ErrorStatus : std::uint32_t { ewgf = 1U << 0U, epvf = 1U << 1U, boff = 1U << 2U };
constexpr unsigned lec_shift = 4;
constexpr std::uint32_t lec_mask = 7U << lec_shift;
constexpr unsigned warning_limit = 96;

constexpr std::uint32_t timing_after_reset = 0x0123'0000;
constexpr std::uint32_t timing_bits = 0xC37F'03FF;
constexpr std::uint32_t silm = 1U << 31U;
constexpr std::uint32_t lbkm = 1U << 30U;

constexpr std::array registers{
    RegisterName{mcr, "MCR"},     RegisterName{msr, "MSR"},     RegisterName{tsr, "TSR"},
    RegisterName{rf0r, "RF0R"},   RegisterName{rf1r, "RF1R"},   RegisterName{ier, "IER"},
    RegisterName{esr, "ESR"},     RegisterName{btr, "BTR"},     RegisterName{0x180, "TI0R"},
    RegisterName{0x184, "TDT0R"}, RegisterName{0x188, "TDL0R"}, RegisterName{0x18C, "TDH0R"},
    RegisterName{0x190, "TI1R"},  RegisterName{0x194, "TDT1R"}, RegisterName{0x198, "TDL1R"},
    RegisterName{0x19C, "TDH1R"}, RegisterName{0x1A0, "TI2R"},  RegisterName{0x1A4, "TDT2R"},
    RegisterName{0x1A8, "TDL2R"}, RegisterName{0x1AC, "TDH2R"}, RegisterName{0x1B0, "RI0R"},
    RegisterName{0x1B4, "RDT0R"}, RegisterName{0x1B8, "RDL0R"}, RegisterName{0x1BC, "RDH0R"},
    RegisterName{0x1C0, "RI1R"},  RegisterName{0x1C4, "RDT1R"}, RegisterName{0x1C8, "RDL1R"},
    RegisterName{0x1CC, "RDH1R"},
};

constexpr std::uint64_t local_time_per_second = local_time_per_us * 1'000'000;

}  // namespace

BxCan::BxCan(ChipServices& chip, Bus& bus, TrueTime true_time)
    : RegisterBlock(chip, "CAN1", 0x4000'6400, 0x400, registers),
      bus_(&bus),
      true_time_(std::move(true_time)),
      controller_(bus.attach(*this)),
      transmitter_(controller_),
      transmit_line_(chip, tx_interrupt),
      fifo_lines_{InterruptLine(chip, rx0_interrupt), InterruptLine(chip, rx1_interrupt)},
      status_line_(chip, sce_interrupt) {
  BxCan::reset();
}

void BxCan::reset() {
  controller_.switch_off();
  controller_.reset_errors();
  controller_.watch(false);
  controller_.set_one_shot(false);
  controller_.set_order(Controller::Order::identifier_then_mailbox);
  requests_.clear();
  mode_ = Mode::sleep;
  is_leaving_ = false;
  has_failed_ = false;
  has_timing_ = false;
  control_ = control_after_reset;
  status_ = 0;
  interrupts_ = 0;
  last_error_ = 0;
  timing_ = timing_after_reset;
  is_warning_ = false;
  transmitter_.reset();
  fifos_ = {};
  filters_.reset();
  self_test_end_ = never_on_chip;
  self_test_free_at_ = 0;
  update_interrupts();
}

// Registers

std::uint32_t BxCan::read(std::uint32_t offset) {
  switch (offset) {
    case mcr:
      return control_;
    case msr:
      return master_status();
    case tsr:
      return transmitter_.mailboxes().status((control_ & txfp) != 0);
    case rf0r:
      return fifos_[0].status();
    case rf1r:
      return fifos_[1].status();
    case ier:
      return interrupts_;
    case esr:
      return error_status();
    case btr:
      return timing_;
    default:
      break;
  }
  if (offset >= first_transmit_mailbox && offset < end_of_mailboxes) {
    return read_mailbox(offset);
  }
  if (!BxCanFilters::contains(offset)) {
    reject_read(offset);
  }
  return filters_.read(offset);
}

std::string BxCan::register_name(std::uint32_t offset) const {
  return BxCanFilters::contains(offset) ? "CAN1_" + BxCanFilters::register_name(offset)
                                        : RegisterBlock::register_name(offset);
}

void BxCan::write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case mcr:
      write_master_control(value);
      break;
    case msr:
      status_ &= ~(value & (erri | wkui | slaki));
      break;
    case tsr:
      for (std::uint32_t aborts = transmitter_.mailboxes().write_status(value), i = 0; aborts != 0;
           aborts >>= 1U, ++i) {
        if ((aborts & 1U) != 0) {
          ask(BxCanRequests::Kind::abort, i);
        }
      }
      break;
    case rf0r:
      fifos_[0].write_status(value);
      break;
    case rf1r:
      fifos_[1].write_status(value);
      break;
    case ier:
      if ((value & ~all_interrupts) != 0) {
        reject_write(ier, value, "reserved bits are not 0");
      }
      interrupts_ = value;
      break;
    case esr:
      last_error_ = (value & lec_mask) >> lec_shift;
      break;
    case btr:
      write_bit_timing(value);
      break;
    default:
      if (offset >= first_transmit_mailbox && offset < end_of_mailboxes) {
        write_mailbox(offset, value);
      } else if (!BxCanFilters::contains(offset)) {
        reject_write(offset, value);
      } else if (const auto rejection = filters_.write(offset, value)) {
        reject_write(offset, value, *rejection);
      }
      break;
  }
  update_interrupts();
}

std::uint32_t BxCan::master_status() const {
  const bool is_on_wire = bus_->busy_until() > bus_->now();
  std::uint32_t value = status_ | samp | rx;
  value |= mode_ == Mode::initialisation ? inak : 0U;
  value |= mode_ == Mode::sleep ? slak : 0U;
  if (is_on_wire && controller_.is_on()) {
    value |= controller_.is_sending() ? txm : rxm;
  }
  return value;
}

std::uint32_t BxCan::error_status() const {
  const std::uint32_t transmit_errors = controller_.transmit_errors();
  const std::uint32_t receive_errors = controller_.receive_errors();
  std::uint32_t value = (receive_errors << 24U) | ((transmit_errors & 0xFFU) << 16U) | (last_error_ << lec_shift);
  value |= std::max(transmit_errors, receive_errors) >= warning_limit ? ewgf : 0U;
  value |= controller_.error_state() != ErrorState::active ? epvf : 0U;
  value |= controller_.error_state() == ErrorState::bus_off ? boff : 0U;
  return value;
}

std::uint32_t BxCan::read_mailbox(std::uint32_t offset) const {
  const std::uint32_t word = offset % 0x10 / 4;
  return offset < first_receive_mailbox ? transmitter_.mailboxes().read((offset - first_transmit_mailbox) / 0x10, word)
                                        : fifos_.at((offset - first_receive_mailbox) / 0x10).read(word);
}

void BxCan::write_master_control(std::uint32_t value) {
  if ((value & ttcm) != 0) {
    reject_write(mcr, value, "time triggered communication is not modelled");
  }
  if ((value & ~(0xFFU | software_reset | dbf)) != 0) {
    reject_write(mcr, value, "reserved bits are not 0");
  }
  if ((value & software_reset) != 0) {
    const BxCanFilters filters = filters_;
    reset();
    filters_ = filters;  // CAN2 shares the filters
    return;
  }
  const bool wants_normal = (value & (inrq | sleep)) == 0;
  const bool leaves_initialisation = (control_ & inrq) != 0;
  const bool leaves_sleep = (control_ & sleep) != 0 && has_timing_;
  if (wants_normal && (leaves_initialisation || leaves_sleep)) {
    require_bit_rate_of_bus();
  }
  if (value != control_) {
    control_ = value;
    ask(BxCanRequests::Kind::control, value);
  }
}

void BxCan::write_mailbox(std::uint32_t offset, std::uint32_t value) {
  if (offset >= first_receive_mailbox) {
    reject_write(offset, value, "receive mailboxes are write-protected");
  }
  const std::uint32_t number = (offset - first_transmit_mailbox) / 0x10;
  if (const auto rejection = transmitter_.mailboxes().write(number, offset % 0x10 / 4, value)) {
    reject_write(offset, value, *rejection);
  }
  if (transmitter_.mailboxes()[number].is_pending) {
    if (is_self_test()) {
      start_self_test(chip().now());
    } else {
      ask(BxCanRequests::Kind::transmit, number);
    }
  }
}

void BxCan::write_bit_timing(std::uint32_t value) {
  if (mode_ != Mode::initialisation) {
    reject_write(btr, value, "it may be written in initialisation mode (MSR.INAK = 1) only");
  }
  if ((value & ~timing_bits) != 0) {
    reject_write(btr, value, "reserved bits are not 0");
  }
  timing_ = value;
  has_timing_ = true;
}

LocalTime BxCan::bit_period() const {
  const std::uint32_t prescaler = (timing_ & 0x3FFU) + 1;
  const std::uint32_t quanta = 1 + ((timing_ >> 16U) & 0xFU) + 1 + ((timing_ >> 20U) & 7U) + 1;
  return chip().clocks().apb1 * prescaler * quanta;
}

void BxCan::require_bit_rate_of_bus() const {
  const LocalTime period = bit_period();
  const std::uint64_t rate = (local_time_per_second + period / 2) / period;
  if (rate != bus_->bit_rate()) {
    reject_write(btr, timing_,
                 std::to_string(rate) + " bit/s at a peripheral clock of " +
                     std::to_string(local_time_per_second / chip().clocks().apb1) + " Hz, the bus has " +
                     std::to_string(bus_->bit_rate()) + " bit/s");
  }
}

// Requests of the program

void BxCan::ask(BxCanRequests::Kind kind, std::uint32_t value) {
  requests_.add(std::max(true_time_(chip().now()), bus_->now()), kind, value);
}

void BxCan::submit(BusTime now) {
  while (const auto request = requests_.take_due(now)) {
    if (has_failed_) {
      continue;
    }
    switch (request->kind) {
      case BxCanRequests::Kind::transmit:
        transmitter_.submit(request->value);
        break;
      case BxCanRequests::Kind::abort:
        transmitter_.abort(request->value);
        break;
      case BxCanRequests::Kind::control:
        apply_control(now, *request);
        break;
    }
  }
  update_interrupts();
}

void BxCan::apply_control(BusTime now, const BxCanRequests::Request& request) {
  const std::uint32_t control = request.value;
  const bool wants_initialisation = (control & inrq) != 0;
  const bool wants_sleep = (control & sleep) != 0;
  // In sleep, SLEEP = 1 keeps it there; elsewhere INRQ comes first (RM0090, figure 336).
  const Mode wanted = mode_ == Mode::sleep && wants_sleep ? Mode::sleep
                      : wants_initialisation              ? Mode::initialisation
                      : wants_sleep                       ? Mode::sleep
                                                          : Mode::normal;
  if (wanted != Mode::normal && controller_.is_on() && bus_->busy_until() > now) {
    requests_.postpone(request, bus_->busy_until());
    return;
  }
  controller_.set_one_shot((control & nart) != 0);
  controller_.set_order((control & txfp) != 0 ? Controller::Order::request
                                              : Controller::Order::identifier_then_mailbox);
  if (wanted != Mode::normal) {
    if (wanted != mode_ || is_leaving_) {
      enter(wanted);
    }
  } else if (mode_ != Mode::normal && !is_leaving_) {
    leave_for_normal();
  } else if ((control & abom) != 0) {
    controller_.recover();
  }
  controller_.watch(mode_ == Mode::sleep || (control & nart) != 0);
}

void BxCan::enter(Mode mode) {
  controller_.switch_off();
  transmitter_.take_back();
  self_test_end_ = never_on_chip;
  is_leaving_ = false;
  if (mode == Mode::sleep && mode_ != Mode::sleep && (interrupts_ & slkie) != 0) {
    status_ |= slaki;
  }
  if (mode != Mode::sleep) {
    status_ &= ~slaki;
  }
  mode_ = mode;
}

void BxCan::leave_for_normal() {
  if (!has_timing_ || (timing_ & (silm | lbkm)) == (silm | lbkm)) {
    mode_ = Mode::normal;
    status_ &= ~slaki;
    if (is_self_test()) {
      start_self_test(chip().now());
      chip().reschedule();
    }
    return;
  }
  controller_.set_role((timing_ & silm) != 0   ? Controller::Role::silent
                       : (timing_ & lbkm) != 0 ? Controller::Role::loop_back
                                               : Controller::Role::normal);
  is_leaving_ = true;
  controller_.join();
}

// What the bus reports

void BxCan::store(const CanFrame& frame) {
  if (const auto match = filters_.match(frame.identifier)) {
    fifos_.at(match->fifo).store(frame, match->index, (control_ & rflm) != 0);
  }
}

void BxCan::received(BusTime /*time*/, const CanFrame& frame) {
  last_error_ = 0;
  store(frame);
  update_warning();
  update_interrupts();
}

void BxCan::transmitted(BusTime /*time*/, const CanFrame& frame) {
  last_error_ = 0;
  transmitter_.transmitted();
  if ((timing_ & lbkm) != 0) {
    store(frame);
  }
  transmitter_.hand_over();
  update_warning();
  update_interrupts();
}

void BxCan::error_seen(BusTime /*time*/, bool was_sending) {
  last_error_ = static_cast<std::uint32_t>(controller_.last_error());
  status_ |= (interrupts_ & lecie) != 0 ? erri : 0U;
  if (was_sending) {
    transmitter_.failed((control_ & nart) != 0);
  }
  update_warning();
  update_interrupts();
}

void BxCan::error_state_changed(BusTime /*time*/) {
  switch (controller_.error_state()) {
    case ErrorState::passive:
      status_ |= (interrupts_ & epvie) != 0 ? erri : 0U;
      break;
    case ErrorState::bus_off:
      status_ |= (interrupts_ & bofie) != 0 ? erri : 0U;
      transmitter_.take_back();
      if ((control_ & abom) != 0) {
        controller_.recover();
      }
      break;
    case ErrorState::active:
      transmitter_.hand_over();
      break;
  }
  update_warning();
  update_interrupts();
}

void BxCan::joined(BusTime /*time*/) {
  is_leaving_ = false;
  mode_ = Mode::normal;
  status_ &= ~slaki;
  controller_.watch((control_ & nart) != 0);
  controller_.recover();
  transmitter_.hand_over();
  update_interrupts();
}

void BxCan::frame_began(BusTime time) {
  if (mode_ == Mode::sleep && !is_leaving_) {
    status_ |= wkui;
    if ((control_ & awum) != 0 && (control_ & sleep) != 0) {
      control_ &= ~sleep;
      requests_.add(time, BxCanRequests::Kind::control, control_);
    }
  } else if (controller_.outbid_mailbox() < BxCanMailboxes::count) {
    transmitter_.lost_arbitration();
  }
  update_interrupts();
}

void BxCan::update_warning() {
  const bool was_warning = std::exchange(is_warning_, (error_status() & ewgf) != 0);
  if (is_warning_ && !was_warning && (interrupts_ & ewgie) != 0) {
    status_ |= erri;
  }
}

void BxCan::update_interrupts() {
  const auto fifo_line = [this](unsigned number) {
    const BxCanFifo& fifo = fifos_.at(number);
    const std::uint32_t enabled = interrupts_ >> (3 * number);
    return ((enabled & fmpie0) != 0 && fifo.is_pending()) || ((enabled & (fmpie0 << 1U)) != 0 && fifo.is_full()) ||
           ((enabled & (fmpie0 << 2U)) != 0 && fifo.is_overrun());
  };
  const bool status_change = ((interrupts_ & errie) != 0 && (status_ & erri) != 0) ||
                             ((interrupts_ & wkuie) != 0 && (status_ & wkui) != 0) ||
                             ((interrupts_ & slkie) != 0 && (status_ & slaki) != 0);
  transmit_line_.set((interrupts_ & tmeie) != 0 && transmitter_.mailboxes().any_completed());
  fifo_lines_[0].set(fifo_line(0));
  fifo_lines_[1].set(fifo_line(1));
  status_line_.set(status_change);
}

// Self-test: loop back and silent mode together, without the bus

bool BxCan::is_self_test() const {
  return mode_ == Mode::normal && has_timing_ && (timing_ & (silm | lbkm)) == (silm | lbkm);
}

void BxCan::clocks_change(const Clocks& next) {
  if (next.apb1 != chip().clocks().apb1 && !is_idle()) {
    throw UnmodelledAccess("CAN1: its clock changes from " +
                           std::to_string(local_time_per_second / chip().clocks().apb1) + " Hz to " +
                           std::to_string(local_time_per_second / next.apb1) + " Hz while it is on the bus");
  }
}

void BxCan::clocks_fail(const Clocks& /*next*/) {
  has_failed_ = has_failed_ || !is_idle();
  if (has_failed_) {
    controller_.switch_off();
    controller_.watch(false);
    transmitter_.take_back();
    self_test_end_ = never_on_chip;
  }
}

bool BxCan::is_idle() const { return mode_ != Mode::normal && !is_leaving_ && requests_.empty(); }

void BxCan::start_self_test(LocalTime now) {
  if (self_test_end_ != never_on_chip) {
    return;
  }
  const BxCanMailboxes& mailboxes = transmitter_.mailboxes();
  if (const auto next = mailboxes.first((control_ & txfp) != 0)) {
    self_test_mailbox_ = *next;
    self_test_end_ = std::max(now, self_test_free_at_) + frame_bits(mailboxes.frame(*next)) * bit_period();
  }
}

void BxCan::advance() {
  if (self_test_end_ > chip().now()) {
    return;
  }
  self_test_free_at_ = self_test_end_ + interframe_bits * bit_period();
  self_test_end_ = never_on_chip;
  BxCanMailboxes& mailboxes = transmitter_.mailboxes();
  store(mailboxes.frame(self_test_mailbox_));
  mailboxes.complete(self_test_mailbox_, BxCanMailboxes::txok);
  start_self_test(self_test_free_at_);
  update_interrupts();
}

}  // namespace proleg::sim
