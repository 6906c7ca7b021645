#pragma once

// A module as the master sees it: dictionary, network states, transactions by the rules of docs/protocol.md, written
// for the tests alone. It computes nothing, writes down what comes into force when, and misbehaves on request.

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "shared/can/transmit_queue.hpp"
#include "shared/canopen/objects.hpp"
#include "shared/canopen/power_state.hpp"
#include "shared/canopen/sdo_server.hpp"
#include "sim/bus/bus.hpp"

namespace proleg::test {

class ScriptedModule final : public sim::BusListener, private canopen::ObjectAccess {
 public:
  struct Effect {
    std::uint32_t tick;
    canopen::Address address;  ///< of the value in force
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

  // The world.
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
      send(encode(canopen::Heartbeat{node, canopen::NmtState::boot_up}));
    }
    if (now >= answer_at_) {
      answer_at_ = never;
      send(answer_);
    }
    if (now >= heartbeat_at_) {
      heartbeat_at_ += value(canopen::object::heartbeat_period.address) * 1000;
      if (!silent) {
        send(encode(canopen::Heartbeat{node, state_}));
      }
    }
    if (now >= sync_at_) {
      if (sync_tick_ % 10 == 0 && !announced_) {
        announced_ = true;
        send(encode(canopen::TickMessage{sync_tick_, configuration_crc}));
        sync_at_ += 1000;
      } else {
        send(canopen::encode_sync(sync_tick_));
        announced_ = false;
        ++sync_tick_;
        sync_at_ += sync_tick_ % 10 == 0 ? 9000 : 10000;
      }
    }
  }

  void received(sim::BusTime time, const CanFrame& frame) override {
    now_ = time / 1000;
    if (state_ != canopen::NmtState::boot_up) {
      hear(frame);
    }
  }
  void transmitted(sim::BusTime time, const CanFrame& frame) override {
    now_ = time / 1000;
    queue_.sent();
    if (frame.identifier == canopen::identifier::sync || frame.identifier == canopen::identifier::tick) {
      hear(frame);
    }
  }

  [[nodiscard]] std::uint32_t value(canopen::Address address) const {
    const auto found = values_.find({address.index, address.sub});
    return found != values_.end() ? found->second : canopen::find_object(address)->default_value;
  }
  [[nodiscard]] canopen::NmtState state() const { return state_; }
  [[nodiscard]] canopen::PowerState power() const { return power_.state(); }
  [[nodiscard]] bool produces_sync() const { return sync_at_ != never; }
  [[nodiscard]] const std::vector<Transaction>& committed() const { return committed_; }
  void send(const CanFrame& frame) { static_cast<void>(queue_.push(frame)); }

  std::uint8_t node;
  sim::Controller& controller;

  // How it is, and how it misbehaves.
  std::uint32_t serial = 0x5E41A1;
  std::uint32_t fingerprint = 0xF1A9;
  std::uint32_t configuration_crc = 0;
  Microseconds boot_delay_us = 3000;
  Microseconds answer_delay_us = 0;  ///< of SDO
  bool deaf = false;                 ///< answers no SDO request
  bool silent = false;               ///< sends no heartbeat
  bool never_starts = false;         ///< stays in Pre-operational
  std::size_t most_pending = 32;     ///< transactions
  /// Answers instead of the module, unless `none`.
  std::function<canopen::AbortCode(const canopen::Object&, bool writes, std::uint32_t value)> refusal;

  // What happened.
  std::vector<Effect> effects;
  std::vector<canopen::EmergencyCode> complaints;
  std::size_t boots = 0;
  std::vector<std::pair<canopen::Address, std::uint32_t>> writes;  ///< since the last boot

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
    power_.reset();
  }

  void complain(canopen::EmergencyCode code) {
    complaints.push_back(code);
    send(encode(canopen::Emergency{node, code, 0x81, 0}));
  }

  void hear(const CanFrame& frame) {
    if (const auto request = canopen::decode_nmt(frame); request && (request->node == 0 || request->node == node)) {
      obey(*request);
    } else if (const auto commit = canopen::decode_commit(frame)) {
      take(*commit);
    } else if (const auto announced = canopen::decode_tick(frame)) {
      announced_tick_ = announced->tick;
    } else if (const auto counter = canopen::decode_sync(frame)) {
      pass(*counter);
    } else if (frame.identifier == canopen::identifier::sdo_request + node && !deaf) {
      if (const auto answer = serve_sdo(node, frame, *this)) {
        answer_ = *answer;
        answer_at_ = now_ + answer_delay_us;
        poll(now_);
      }
    } else if (frame.identifier == canopen::identifier::heartbeat + node ||
               frame.identifier == canopen::identifier::sdo_answer + node) {
      complain(canopen::EmergencyCode::identifier_collision);
    }
  }

  void obey(const canopen::NmtRequest& request) {
    switch (request.command) {
      case canopen::NmtCommand::start:
        state_ = never_starts ? state_ : canopen::NmtState::operational;
        return;
      case canopen::NmtCommand::stop:
        state_ = canopen::NmtState::stopped;
        break;
      case canopen::NmtCommand::enter_pre_operational:
        state_ = canopen::NmtState::pre_operational;
        break;
      case canopen::NmtCommand::reset_node:
      case canopen::NmtCommand::reset_communication:
        reset(now_);
        return;
    }
    sync_at_ = never;
    tick_.reset();
  }

  void take(const canopen::CommitMessage& commit) {
    for (const Transaction& waiting : committed_) {
      if (waiting.number == commit.transaction && waiting.tick == commit.tick) {
        return;
      }
    }
    if (last_.number == commit.transaction && last_.tick == commit.tick) {
      return;
    }
    if (!open_ || open_->number != commit.transaction) {
      if (value(canopen::object::activate.address) == 1) {
        complain(canopen::EmergencyCode::commit_not_staged);
      }
      return;
    }
    if (tick_ && commit.tick <= *tick_) {
      complain(canopen::EmergencyCode::commit_too_late);
      return;
    }
    open_->tick = commit.tick;
    committed_.push_back(*open_);
    open_.reset();
  }

  /// SYNC: transactions for this tick come into force; after a restart also those for earlier ones, without
  /// distortions.
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

  canopen::AbortCode read(const canopen::Object& object, std::uint32_t& result) override {
    if (const canopen::AbortCode code = refused(object, false, 0); code != canopen::AbortCode::none) {
      return code;
    }
    if (object.address == canopen::object::serial.address) {
      result = serial;
    } else if (object.address == canopen::object::core_fingerprint.address) {
      result = fingerprint;
    } else if (object.address == canopen::object::configuration_crc.address) {
      result = configuration_crc;
    } else {
      result = value(object.address);
    }
    return canopen::AbortCode::none;
  }

  canopen::AbortCode write(const canopen::Object& object, std::uint32_t written) override {
    using namespace canopen;
    if (const AbortCode code = refused(object, true, written); code != AbortCode::none) {
      return code;
    }
    const Address address = object.address;
    writes.emplace_back(address, written);
    if (const auto kind = value_address(address); kind && kind->kind != ValueKind::parameter) {
      return stage(address, static_cast<std::int32_t>(written));
    }
    if (address == object::transaction.address) {
      return open(static_cast<std::uint16_t>(written));
    }
    if (address.index >= 0x3000 && address.index < 0x4000) {  // a new start drops what is staged
      open_.reset();
      committed_.clear();
    }
    values_[{address.index, address.sub}] = written;
    if (address == object::heartbeat_period.address) {
      heartbeat_at_ = now_;
    } else if (address == object::controlword.address) {
      power_.command(static_cast<std::uint16_t>(written));
    } else if (address == object::sync_identifier.address) {
      const bool on = (written & canopen::produces_sync) != 0;
      if (on && state_ != NmtState::operational) {
        return AbortCode::refused_by_state;
      }
      sync_at_ = on ? now_ : never;
      sync_tick_ = 0;
      announced_ = false;
    }
    return AbortCode::none;
  }

  canopen::AbortCode refused(const canopen::Object& object, bool writing, std::uint32_t written) const {
    return refusal ? refusal(object, writing, written) : canopen::AbortCode::none;
  }

  canopen::AbortCode open(std::uint16_t number) {
    const auto same = std::ranges::find(committed_, number, &Transaction::number);
    if (same != committed_.end()) {
      return canopen::AbortCode::refused_by_state;
    }
    if (!open_ || open_->number != number) {
      if (committed_.size() >= most_pending) {
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
    if (count >= max_staged_values) {
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
  canopen::PowerControl power_;
};

}  // namespace proleg::test
