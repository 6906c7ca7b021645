#pragma once

// A module as the master sees it, for the tests alone: dictionary, network states and transactions by the rules of
// docs/protocol.md. It packs and reads all frames by itself, from CiA 301 and docs/protocol.md; it shares with the code
// under test the names of states, codes and addresses, and the transmit queue. It computes nothing, records the values
// that take effect and their ticks, and has faults on request.

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "shared/can/transmit_queue.hpp"
#include "shared/canopen/objects.hpp"
#include "shared/canopen/power_state.hpp"
#include "sim/bus/bus.hpp"

namespace proleg::test {

class ScriptedModule final : public sim::BusListener {
 public:
  struct Effect {
    std::uint32_t tick;
    canopen::Address address;  ///< address of the value in force
    std::int32_t value;

    friend bool operator==(const Effect&, const Effect&) = default;
  };
  struct Transaction {
    std::uint16_t number = 0;
    std::uint32_t tick = 0;
    std::vector<std::pair<canopen::Address, std::int32_t>> values;
  };

  ScriptedModule(sim::Bus& bus, std::uint8_t node_id)
      : node(node_id), controller(bus.attach(*this)), queue_(controller) {
    controller.switch_off();
  }

  // Events from outside.
  void power_on(Microseconds now) {
    controller.switch_on();
    reset(now);
  }
  void power_off() {
    controller.switch_off();
    queue_.clear();
    state_ = canopen::NmtState::boot_up;
    boot_at_ = heartbeat_at_ = sync_at_ = answer_at_ = never;
  }
  [[nodiscard]] Microseconds next_deadline() const { return std::min({boot_at_, heartbeat_at_, sync_at_, answer_at_}); }
  void poll(Microseconds now) {
    now_ = now;
    if (now >= boot_at_) {
      boot_at_ = never;
      state_ = canopen::NmtState::pre_operational;
      send_heartbeat(0x00);
    }
    if (now >= answer_at_) {
      answer_at_ = never;
      send(answer_);
    }
    if (now >= heartbeat_at_) {
      heartbeat_at_ += value({0x1017, 0}) * 1000;
      if (!silent) {
        send_heartbeat(static_cast<std::uint8_t>(state_));
      }
    }
    if (now >= sync_at_) {
      if (sync_tick_ % 10 == 0 && !announced_) {
        announced_ = true;
        send(packed(0x681, {{4, sync_tick_}, {4, configuration_crc}}));
        sync_at_ += 1000;
      } else {
        send(packed(0x080, {{1, sync_tick_ % 128 + 1}}));
        announced_ = false;
        ++sync_tick_;
        sync_at_ += sync_tick_ % 10 == 0 ? 9000 : 10000;
      }
    }
  }

  void received(sim::BusTime time, const CanFrame& frame) override {
    now_ = time / 1000;
    if (state_ != canopen::NmtState::boot_up) {
      handle(frame);
    }
  }
  void transmitted(sim::BusTime time, const CanFrame& frame) override {
    now_ = time / 1000;
    queue_.sent();
    if (frame.identifier == 0x080 || frame.identifier == 0x681) {
      handle(frame);
    }
  }

  [[nodiscard]] std::uint32_t value(canopen::Address address) const {
    const auto found = values_.find({address.index, address.sub});
    return found != values_.end() ? found->second : canopen::find_object(address)->default_value;
  }
  [[nodiscard]] canopen::NmtState state() const { return state_; }
  [[nodiscard]] canopen::PowerState power() const { return power_; }
  [[nodiscard]] bool produces_sync() const { return sync_at_ != never; }
  [[nodiscard]] const std::vector<Transaction>& committed() const { return committed_; }
  void send(const CanFrame& frame) { static_cast<void>(queue_.push(frame)); }

  std::uint8_t node;
  sim::Controller& controller;

  // Properties and faults.
  std::uint32_t product = 0;
  std::uint32_t serial = 0x5E41A1;
  std::uint32_t fingerprint = 0xF1A9;
  std::uint32_t configuration_crc = 0;
  Microseconds boot_delay_us = 3000;
  Microseconds answer_delay_us = 0;                       ///< delay of SDO answers
  std::map<std::uint8_t, std::uint32_t> user_algorithms;  ///< sources of users' algorithms (0x200F), by sub-index
  bool ignores_sdo = false;                               ///< answers no SDO request
  bool silent = false;                                    ///< sends no heartbeat
  bool never_starts = false;                              ///< stays in Pre-operational
  std::size_t max_pending = 32;                           ///< greatest number of transactions
  std::uint32_t lease = 0;                                ///< token that has the lease (0x2002); a reset ends it
  bool measures_angle = true;
  std::int32_t measured = 0;    ///< measured angle, 0x6064
  Microseconds ramp_in_us = 0;  ///< time from the power to the start of the gait
  /// Abort code that the module answers, unless it is `none`.
  std::function<canopen::AbortCode(canopen::Address, bool writes, std::uint32_t value)> refusal;

  // Records of events.
  std::vector<Effect> effects;
  std::vector<canopen::EmergencyCode> emergencies;
  std::size_t boots = 0;
  std::vector<std::pair<canopen::Address, std::uint32_t>> writes;  ///< writes since the last boot

 private:
  void reset(Microseconds now) {
    now_ = now;
    ++boots;
    queue_.clear();
    controller.abort_all();
    state_ = canopen::NmtState::boot_up;
    boot_at_ = now + boot_delay_us;
    heartbeat_at_ = sync_at_ = answer_at_ = never;
    values_.clear();
    writes.clear();
    open_.reset();
    committed_.clear();
    last_ = {};
    tick_.reset();
    announced_tick_.reset();
    power_ = canopen::PowerState::switch_on_disabled;
    lease = 0;
  }

  /// A field of a frame: number of bytes and value.
  using Field = std::pair<unsigned, std::uint32_t>;

  static CanFrame packed(unsigned identifier, std::initializer_list<Field> fields) {
    CanFrame frame{static_cast<std::uint16_t>(identifier), 0, {}};
    for (auto [bytes, value] : fields) {
      for (; bytes > 0; --bytes, value >>= 8U) {
        frame.data.at(frame.length++) = static_cast<std::uint8_t>(value & 0xFFU);
      }
    }
    return frame;
  }
  static std::uint32_t field(const CanFrame& frame, std::size_t position, std::size_t bytes) {
    std::uint32_t value = 0;
    while (bytes-- > 0) {
      value = value * 256 + frame.data.at(position + bytes);
    }
    return value;
  }

  void send_heartbeat(std::uint8_t state) { send(packed(0x700U + node, {{1, state}})); }

  void report(canopen::EmergencyCode code) {
    emergencies.push_back(code);
    send(packed(0x080U + node, {{2, static_cast<std::uint32_t>(code)}, {1, 0x81}, {4, 0}, {1, 0}}));
  }

  void handle(const CanFrame& frame) {
    if (frame.identifier == 0x000 && frame.length == 2 && (frame.data[1] == 0 || frame.data[1] == node)) {
      change_state(frame.data[0]);
    } else if (frame.identifier == 0x680 && frame.length == 8) {
      commit(static_cast<std::uint16_t>(field(frame, 0, 2)), field(frame, 2, 4));
    } else if (frame.identifier == 0x681 && frame.length == 8) {
      announced_tick_ = field(frame, 0, 4);
    } else if (frame.identifier == 0x080 && frame.length == 1) {
      pass(frame.data[0]);
    } else if (frame.identifier == 0x600 + node && frame.length == 8 && !ignores_sdo) {
      answer_ = sdo_answer(frame);
      answer_at_ = now_ + answer_delay_us;
      poll(now_);
    } else if (frame.identifier == 0x700 + node || frame.identifier == 0x580 + node) {
      report(canopen::EmergencyCode::identifier_collision);
    }
  }

  /// Handles NMT (CiA 301, 7.2.8.3.1).
  void change_state(std::uint8_t command) {
    switch (command) {
      case 0x01:
        state_ = never_starts ? state_ : canopen::NmtState::operational;
        return;
      case 0x02:
        state_ = canopen::NmtState::stopped;
        break;
      case 0x80:
        state_ = canopen::NmtState::pre_operational;
        break;
      case 0x81:
      case 0x82:
        reset(now_);
        return;
      default:
        return;
    }
    sync_at_ = never;
    tick_.reset();
  }

  /// Size in bytes of an entry that the master uses, from docs/objects.md; 0 for others.
  static unsigned size_of(canopen::Address address) {
    switch (address.index) {
      case 0x1005:
      case 0x1006:
      case 0x1016:
      case 0x1018:
      case 0x2002:
      case 0x2007:
      case 0x2008:
      case 0x200D:
      case 0x200F:
      case 0x6064:
      case 0x607A:
      case 0x6080:
        return 4;
      case 0x1017:
      case 0x2004:
      case 0x200E:
      case 0x6040:
      case 0x6041:
        return 2;
      case 0x1019:
      case 0x2006:
      case 0x6060:
        return 1;
      case 0x2000:
        return address.sub == 1 ? 2 : 4;
      case 0x2001:
        return address.sub <= 4 ? 1 : (address.sub == 5 ? 2 : 4);
      case 0x2005:
        return address.sub == 6 ? 1 : 4;
      default:
        return (address.index >= 0x1410 && address.index < 0x1490) ||
                       (address.index >= 0x3000 && address.index < 0x6000)
                   ? 4
                   : 0;
    }
  }

  /// Handles expedited transfers (CiA 301, 7.2.4.3).
  CanFrame sdo_answer(const CanFrame& request) {
    const canopen::Address address{static_cast<std::uint16_t>(field(request, 1, 2)), request.data[3]};
    const auto answer = [&](std::uint8_t command, std::uint32_t data) {
      return packed(0x580U + node, {{1, command}, {2, address.index}, {1, address.sub}, {4, data}});
    };
    const auto abort = [&](std::uint32_t code) { return answer(0x80, code); };
    const unsigned size = size_of(address);
    if (size == 0) {
      return abort(0x06020000);  // no such object
    }
    const auto command_of_size = [size](unsigned command) {
      return static_cast<std::uint8_t>(command | (4 - size) << 2U | 3U);
    };
    if (request.data[0] == 0x40) {
      const canopen::AbortCode code = refused(address, false, 0);
      return code == canopen::AbortCode::none ? answer(command_of_size(0x40), read(address))
                                              : abort(static_cast<std::uint32_t>(code));
    }
    if (request.data[0] != command_of_size(0x20)) {
      return abort(0x06070010);  // wrong length
    }
    const canopen::AbortCode code = write(address, field(request, 4, size));
    return code == canopen::AbortCode::none ? answer(0x60, 0) : abort(static_cast<std::uint32_t>(code));
  }

  void commit(std::uint16_t number, std::uint32_t tick) {
    for (const Transaction& waiting : committed_) {
      if (waiting.number == number && waiting.tick == tick) {
        return;
      }
    }
    if (last_.number == number && last_.tick == tick) {
      return;
    }
    if (!open_ || open_->number != number) {
      if (value({0x2005, 6}) == 1) {
        report(canopen::EmergencyCode::commit_not_staged);
      }
      return;
    }
    if (tick_ && tick <= *tick_) {
      report(canopen::EmergencyCode::commit_too_late);
      return;
    }
    open_->tick = tick;
    committed_.push_back(*open_);
    open_.reset();
  }

  /// Handles SYNC: transactions for this tick take effect; after a restart also those for earlier ticks, without
  /// internal values.
  void pass(std::uint8_t counter) {
    if (announced_tick_ && *announced_tick_ % 128 + 1 == counter) {
      tick_ = announced_tick_;
    } else if (tick_) {
      ++*tick_;
    }
    announced_tick_.reset();
    if (!tick_ || state_ != canopen::NmtState::operational) {
      return;
    }
    for (std::size_t i = 0; i < committed_.size();) {
      if (committed_[i].tick > *tick_) {
        ++i;
        continue;
      }
      for (const auto& [address, staged] : committed_[i].values) {
        const bool internal = address.index >= 0x5000;
        if (!internal || committed_[i].tick == *tick_) {
          const canopen::Address in_force{internal ? address.index : static_cast<std::uint16_t>(address.index - 0x1000),
                                          address.sub};
          effects.push_back({committed_[i].tick, in_force, staged});
          values_[{in_force.index, in_force.sub}] = static_cast<std::uint32_t>(staged);
        }
      }
      last_ = committed_[i];
      committed_.erase(committed_.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }

  std::uint32_t read(canopen::Address address) const {
    if (address == canopen::Address{0x1018, 1}) {
      return 0x50524F4C;  // the placeholder vendor
    }
    if (address == canopen::Address{0x1018, 2}) {
      return product;
    }
    if (address == canopen::Address{0x1018, 4}) {
      return serial;
    }
    if (address == canopen::Address{0x2000, 1}) {
      return 0x0100;  // version of the protocol
    }
    if (address == canopen::Address{0x2000, 3}) {
      return fingerprint;
    }
    if (address == canopen::Address{0x2000, 5}) {
      return measures_angle ? 1 : 0;
    }
    if (address == canopen::Address{0x2002, 0}) {
      return lease;
    }
    if (address.index == 0x200F) {
      const auto found = user_algorithms.find(address.sub);
      return found == user_algorithms.end() ? 0 : found->second;
    }
    if (address == canopen::Address{0x6064, 0}) {
      return static_cast<std::uint32_t>(measured);
    }
    if (address == canopen::Address{0x6041, 0}) {
      return statusword();
    }
    return address == canopen::Address{0x2001, 6} ? configuration_crc : value(address);
  }

  /// The statusword (CiA 402); bit 10: has ramped in.
  std::uint32_t statusword() const {
    switch (power_) {
      case canopen::PowerState::ready_to_switch_on:
        return 0x21;
      case canopen::PowerState::switched_on:
        return 0x23;
      case canopen::PowerState::operation_enabled:
        return now_ - enabled_at_ >= ramp_in_us ? 0x427 : 0x27;
      default:
        return 0x40;
    }
  }

  canopen::AbortCode write(canopen::Address address, std::uint32_t written) {
    using namespace canopen;
    if (const AbortCode code = refused(address, true, written); code != AbortCode::none) {
      return code;
    }
    if (address == Address{0x2002, 0}) {
      if (lease != 0 && lease != written) {
        return AbortCode::refused_by_state;
      }
      lease = written;
    }
    writes.emplace_back(address, written);
    if (address.index >= 0x4000 && address.index < 0x6000) {
      return stage(address, static_cast<std::int32_t>(written));
    }
    if (address == Address{0x2004, 1}) {
      return open(static_cast<std::uint16_t>(written));
    }
    if (address.index >= 0x3000 && address.index < 0x4000) {  // a new start drops the staged values
      open_.reset();
      committed_.clear();
    }
    values_[{address.index, address.sub}] = written;
    if (address == Address{0x1017, 0}) {
      heartbeat_at_ = now_;
    } else if (address == Address{0x6040, 0}) {
      control_power(written);
    } else if (address == Address{0x1005, 0}) {
      const bool on = (written & 0x40000000U) != 0;
      if (on && state_ != NmtState::operational) {
        return AbortCode::refused_by_state;
      }
      sync_at_ = on ? now_ : never;
      sync_tick_ = 0;
      announced_ = false;
    }
    return AbortCode::none;
  }

  /// The controlwords that enable a servo one after the other, and 0 (CiA 402).
  void control_power(std::uint32_t controlword) {
    using enum canopen::PowerState;
    if (controlword == 0x0000) {
      power_ = switch_on_disabled;
    } else if (controlword == 0x0006 && power_ == switch_on_disabled) {
      power_ = ready_to_switch_on;
    } else if (controlword == 0x0007 && power_ == ready_to_switch_on) {
      power_ = switched_on;
    } else if (controlword == 0x000F && power_ == switched_on) {
      power_ = operation_enabled;
      enabled_at_ = now_;
    }
  }

  canopen::AbortCode refused(canopen::Address address, bool writing, std::uint32_t written) const {
    return refusal ? refusal(address, writing, written) : canopen::AbortCode::none;
  }

  canopen::AbortCode open(std::uint16_t number) {
    const auto same = std::ranges::find(committed_, number, &Transaction::number);
    if (same != committed_.end()) {
      return canopen::AbortCode::refused_by_state;
    }
    if (!open_ || open_->number != number) {
      if (committed_.size() >= max_pending) {
        return canopen::AbortCode::out_of_memory;
      }
      open_ = Transaction{number, 0, {}};
    }
    return canopen::AbortCode::none;
  }

  canopen::AbortCode stage(canopen::Address address, std::int32_t staged) {
    if (!open_) {
      return canopen::AbortCode::refused_by_state;
    }
    std::size_t count = open_->values.size();
    for (const Transaction& waiting : committed_) {
      count += waiting.values.size();
    }
    if (count >= 128) {  // docs/protocol.md
      return canopen::AbortCode::out_of_memory;
    }
    const auto again = std::ranges::find(open_->values, address, &std::pair<canopen::Address, std::int32_t>::first);
    if (again != open_->values.end()) {
      again->second = staged;
    } else {
      open_->values.emplace_back(address, staged);
    }
    return canopen::AbortCode::none;
  }

  TransmitQueue queue_;
  Microseconds now_ = 0;
  canopen::NmtState state_ = canopen::NmtState::boot_up;
  Microseconds boot_at_ = never;
  Microseconds heartbeat_at_ = never;
  Microseconds sync_at_ = never;
  Microseconds answer_at_ = never;
  CanFrame answer_;
  std::uint32_t sync_tick_ = 0;
  bool announced_ = false;
  std::map<std::pair<std::uint16_t, std::uint8_t>, std::uint32_t> values_;
  std::optional<Transaction> open_;
  std::vector<Transaction> committed_;
  Transaction last_;
  std::optional<std::uint32_t> tick_;
  std::optional<std::uint32_t> announced_tick_;
  canopen::PowerState power_ = canopen::PowerState::switch_on_disabled;
  Microseconds enabled_at_ = 0;
};

}  // namespace proleg::test
