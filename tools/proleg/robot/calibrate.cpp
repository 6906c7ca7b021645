// proleg calibrate: teaches a module the feedback potentiometer of its joint.

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/robot/object_word.hpp"
#include "shared/canopen/declared_objects.hpp"
#include "shared/canopen/messages.hpp"
#include "shared/canopen/power_state.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/program_report.hpp"
#include "tools/proleg/common/terminal.hpp"
#include "tools/proleg/robot/bus_access.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;
namespace object = canopen::object;

struct CalibrateOptions : BusOptions {
  std::string node;
  ProgramReport report;
};

/// What a module knows of its potentiometer.
struct Calibration {
  std::uint32_t is_fitted = 0;
  std::uint32_t at_minus_90 = 0;
  std::uint32_t at_plus_90 = 0;

  [[nodiscard]] Json json() const {
    return {{"fitted", is_fitted != 0}, {"at_minus_90", at_minus_90}, {"at_plus_90", at_plus_90}};
  }
  friend bool operator==(const Calibration&, const Calibration&) = default;
};

/// A joint that is turned by hand to both ends of its range. Each failure is a std::runtime_error.
class Calibrating {
 public:
  Calibrating(std::uint8_t node, const ProgramReport& report, BusAccess& bus)
      : node_(node),
        report_(report),
        bus_(bus),
        presence_(bus.connection()),
        queue_(bus.connection(), patient_transfers()) {}

  void run() {
    take_power();
    const Calibration before = read_calibration();
    Calibration now{1, 0, 0};
    now.at_minus_90 = ask_for_reading("lower", "-90");
    now.at_plus_90 = ask_for_reading("upper", "+90");
    require_range(now);
    write(now);
    restart();
    if (!(read_calibration() == now)) {
      throw std::runtime_error(name() + " has other values after its restart than those that it has stored");
    }
    report_.print_result(Json{{"node", unsigned{node_}}, {"before", before.json()}, {"now", now.json()}});
    if (report_.is_text()) {
      std::cout << name() << ": the potentiometer reads " << now.at_minus_90 << " at -90 degrees and " << now.at_plus_90
                << " at +90 degrees; stored\n";
    }
  }

 private:
  static constexpr Microseconds second = 1'000'000;
  /// 2 degrees of a potentiometer that uses most of its range.
  static constexpr std::uint32_t steady_readings = 40;
  static constexpr std::uint32_t averaged = 8;

  [[nodiscard]] std::string name() const { return "node " + std::to_string(node_); }

  std::uint32_t read(const canopen::Object& object) {
    std::uint32_t number = 0;
    std::optional<canopen::AbortCode> failure;
    queue_.read(node_, object.address, [&](const host::SdoResult& result) {
      number = result.number();
      failure = result.is_good() ? std::nullopt : std::optional(result.abort_code);
    });
    finish(bus_, queue_);
    if (failure) {
      throw std::runtime_error(
          failure_text(node_, host::address_text(object.address), *failure, bus_.connection().diagnosis()));
    }
    return number;
  }
  void write(const canopen::Object& object, std::uint32_t value) {
    std::optional<canopen::AbortCode> failure;
    queue_.write(node_, object.address, object.type, value, [&](const host::SdoResult& result) {
      failure = result.is_good() ? std::nullopt : std::optional(result.abort_code);
    });
    finish(bus_, queue_);
    if (failure) {
      throw std::runtime_error(
          failure_text(node_, host::address_text(object.address), *failure, bus_.connection().diagnosis()));
    }
  }
  void send(canopen::NmtCommand command) {
    bus_.wait_for("room for a frame", second, [this, command] {
      return bus_.connection().send(canopen::encode(canopen::NmtRequest{command, node_}));
    });
  }

  /// A person turns the joint: its servo must not hold it. A module in operation stores nothing.
  void take_power() {
    const std::uint32_t state = read(object::statusword) & canopen::drive_state_bits;
    if (state == canopen::drive_operation_enabled || state == canopen::drive_quick_stop_active) {
      throw std::runtime_error(name() + ": its servo has power; switch it off first");
    }
    send(canopen::NmtCommand::enter_pre_operational);
  }

  Calibration read_calibration() {
    return {read(object::has_feedback), read(object::feedback_at_minus_90), read(object::feedback_at_plus_90)};
  }

  /// The potentiometer's reading where the person says that the joint is.
  std::uint32_t ask_for_reading(const char* question, const std::string& degrees) {
    std::vector<std::uint32_t> readings;
    for (;;) {
      report_.print_event("question", {{"question", question}, {"node", unsigned{node_}}});
      if (report_.is_text()) {
        std::cerr << "Turn the joint of " << name() << " to " << degrees
                  << " degrees, hold it there, and press Enter (or answer quit). " << std::flush;
      }
      const std::string word = next_line(readings);
      if (word == "quit" || word == "q") {
        throw std::runtime_error("ended by the user; nothing was written");
      }
      const auto [lowest, highest] = std::ranges::minmax(readings);
      if (readings.size() >= averaged && highest - lowest <= steady_readings) {
        std::uint32_t sum = 0;
        for (const std::uint32_t reading : readings) {
          sum += reading;
        }
        return (sum + averaged / 2) / averaged;
      }
      const std::string text = "the joint moves: the last readings are from " + std::to_string(lowest) + " to " +
                               std::to_string(highest) + "; hold it still";
      report_.print_event("refused", {{"text", text}});
      if (report_.is_text()) {
        std::cerr << text << '\n';
      }
    }
  }

  /// The next line of the person; meanwhile the last readings.
  std::string next_line(std::vector<std::uint32_t>& readings) {
    constexpr Microseconds patience = 600 * second;
    constexpr Microseconds period = second / 10;
    const Microseconds end = bus_.connection().now() + patience;
    readings.clear();
    for (;;) {
      const std::uint32_t reading = read(object::feedback_reading);
      if (reading == canopen::feedback_not_read) {
        throw std::runtime_error(name() + ": its ADC does not read the potentiometer");
      }
      readings.push_back(reading);
      if (readings.size() > averaged) {
        readings.erase(readings.begin());
      }
      show(reading);
      const auto line = readings.size() < averaged ? std::nullopt : lines_.next();
      if (line) {
        progress_.erase();
        return lower_case(trimmed(*line));
      }
      if (lines_.has_ended() || bus_.connection().now() > end) {
        throw std::runtime_error("standard input has ended without an answer; nothing was written");
      }
      bus_.connection().run_for(period);
      if (interrupted()) {
        throw std::runtime_error("interrupted; nothing was written");
      }
    }
  }

  void show(std::uint32_t reading) {
    const auto position = static_cast<std::int32_t>(read(object::actual_position));
    report_.print_event(
        "reading",
        {{"node", unsigned{node_}},
         {"reading", reading},
         {"angle", position == canopen::position_not_measured ? Json() : Json(90.0 * position / (1 << 30))}});
    if (report_.is_text() && progress_.is_due()) {
      progress_.draw("potentiometer " + std::to_string(reading));
    }
  }

  static void require_range(const Calibration& now) {
    constexpr std::uint32_t smallest_range = 200;
    const std::uint32_t range = std::max(now.at_minus_90, now.at_plus_90) - std::min(now.at_minus_90, now.at_plus_90);
    if (range < smallest_range) {
      throw std::runtime_error("found the readings " + std::to_string(now.at_minus_90) + " and " +
                               std::to_string(now.at_plus_90) + ", expected at least " +
                               std::to_string(smallest_range) +
                               " between them: is a potentiometer wired to the module? Nothing was written");
    }
  }

  void write(const Calibration& now) {
    write(object::feedback_at_minus_90, now.at_minus_90);
    write(object::feedback_at_plus_90, now.at_plus_90);
    write(object::has_feedback, now.is_fitted);
    canopen::SdoTransferOptions options = patient_transfers();
    options.timeout_us = canopen::storing_time_us;
    host::SdoQueue store(bus_.connection(), options);
    std::optional<canopen::AbortCode> failure;
    store.write(node_, object::store_parameters.address, object::store_parameters.type, canopen::signature_save,
                [&](const host::SdoResult& result) {
                  failure = result.is_good() ? std::nullopt : std::optional(result.abort_code);
                });
    finish(bus_, store);
    if (failure) {
      throw std::runtime_error(
          failure_text(node_, "the store of its settings", *failure, bus_.connection().diagnosis()));
    }
  }

  /// The values are in force after a reset.
  void restart() {
    class BootWatch final : public host::BusUser {
     public:
      explicit BootWatch(std::uint8_t node) : node_(node) {}
      void receive(Microseconds /*now*/, const CanFrame& frame) override {
        const auto heartbeat = canopen::decode_heartbeat(frame);
        has_booted =
            has_booted || (heartbeat && heartbeat->node == node_ && heartbeat->state == canopen::NmtState::boot_up);
      }
      bool has_booted = false;

     private:
      std::uint8_t node_;
    };
    constexpr Microseconds longest = 5 * second;
    BootWatch watch(node_);
    const host::BusAttachment attachment(bus_.connection(), watch);
    send(canopen::NmtCommand::reset_node);
    bus_.wait_for("the restart of " + name(), longest, [&watch] { return watch.has_booted; });
  }

  std::uint8_t node_;
  const ProgramReport& report_;
  BusAccess& bus_;
  HostPresence presence_;
  host::SdoQueue queue_;
  InputLines lines_;
  TerminalLine progress_{std::chrono::milliseconds(0)};
};

int calibrate(const CalibrateOptions& options) {
  const auto nodes = host::parse_nodes(options.node);
  if (!nodes || nodes->size() != 1) {
    throw InputError("NODE", 0, in_quotes(options.node), "one node id");
  }
  BusAccess bus(options);
  catch_interrupts();
  options.report.begin();
  require_no_host(bus);
  Calibrating(nodes->front(), options.report, bus).run();
  return exit_success;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line(
      "proleg calibrate",
      "Teaches a module the feedback potentiometer of its joint. You turn the joint by hand to -90 "
      "and to +90 degrees and press Enter at each; its servo has no power. The module stores the "
      "two readings and restarts.");
  CalibrateOptions options;
  command_line.add_option("NODE", options.node, "the node id of the module").required();
  add_bus_option(command_line, options);
  options.report.add_options(command_line);
  return command_line.run(argc, argv, [&] { return calibrate(options); });
}
