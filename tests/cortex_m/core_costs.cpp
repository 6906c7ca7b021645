#include "tests/cortex_m/core_costs.hpp"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <string>
#include <string_view>

#include "shared/gait/registry.hpp"

namespace proleg::cortex_m {
namespace {

constexpr std::uint32_t joint_count = 5;
constexpr std::uint32_t measured_joint = 2;
constexpr std::uint64_t budget = 1'000'000;

class Statistics {
 public:
  void add(std::uint64_t instructions) {
    sum_ += instructions;
    ++count_;
    worst_ = std::max(worst_, instructions);
  }
  [[nodiscard]] Instructions result() const { return {static_cast<double>(sum_) / count_, worst_}; }

 private:
  std::uint64_t sum_ = 0;
  int count_ = 0;
  std::uint64_t worst_ = 0;
};

/// The five modules in the image.
class Modules {
 public:
  Modules(Machine& machine, std::uint8_t algorithm_id) : machine_(machine) {
    const std::uint32_t configuration = machine.call("benchmark_configuration", {algorithm_id}, budget).value;
    for (std::uint32_t joint = 0; joint < joint_count; ++joint) {
      kernels_[joint] = machine.call("benchmark_kernel", {joint}, budget).value;
      frames_[joint] = machine.call("benchmark_frame", {joint}, budget).value;
      expect_ok("proleg::Kernel::configure", {kernels_[joint], configuration, joint});
    }
  }

  /// Calls a function of a module's kernel.
  CallResult call(std::string_view function, std::uint32_t joint, std::initializer_list<std::uint32_t> arguments) {
    std::vector<std::uint32_t> all{kernels_[joint]};
    all.insert(all.end(), arguments);
    return machine_.call(function, all, budget);
  }

  /// As call, for functions that return a Status.
  void expect_ok(std::string_view function, const std::vector<std::uint32_t>& arguments) {
    const std::uint32_t status = machine_.call(function, arguments, budget).value;
    if (status != 0) {
      throw RunError(std::string(function) + " answers with status " + std::to_string(status));
    }
  }

  /// All frames of the others to a joint. Returns the instructions of that.
  std::uint64_t receive_all(std::uint32_t receiver) {
    std::uint64_t spent = 0;
    for (std::uint32_t sender = 0; sender < joint_count; ++sender) {
      if (sender == receiver) {
        continue;
      }
      const CallResult result = call("proleg::Kernel::receive", receiver, {sender, 0, frames_[sender]});
      if ((result.value & 1U) == 0) {
        throw RunError("a kernel rejects a frame of its tick");
      }
      spent += result.instructions;
    }
    return spent;
  }

  /// Gives parameters of a joint their values, before its first tick.
  void set(const MeasuredJoint& measured) {
    constexpr std::uint32_t transaction = 1;
    constexpr std::uint32_t slot = 0;
    const std::uint32_t kernel = kernels_[measured.joint];
    for (const auto& [number, value] : measured.parameters) {
      expect_ok("proleg::Kernel::stage",
                {kernel, transaction, slot, measured.joint, number, static_cast<std::uint32_t>(value)});
    }
    if (!measured.parameters.empty()) {
      expect_ok("proleg::Kernel::commit", {kernel, transaction, 0});
    }
  }

  /// All frames to all others. Returns the instructions that the measured joint spends on receiving.
  std::uint64_t exchange(std::uint32_t measured = measured_joint) {
    std::uint64_t spent = 0;
    for (std::uint32_t receiver = 0; receiver < joint_count; ++receiver) {
      const std::uint64_t instructions = receive_all(receiver);
      spent += receiver == measured ? instructions : 0;
    }
    return spent;
  }

  [[nodiscard]] std::uint32_t kernel(std::uint32_t joint) const { return kernels_[joint]; }
  [[nodiscard]] std::uint32_t frame(std::uint32_t joint) const { return frames_[joint]; }

 private:
  Machine& machine_;
  std::array<std::uint32_t, joint_count> kernels_{};
  std::array<std::uint32_t, joint_count> frames_{};
};

/// The deepest stack of each function so far.
class StackMeter {
 public:
  explicit StackMeter(Machine& machine) : machine_(machine) {}

  CallResult call(std::string_view function, const std::vector<std::uint32_t>& arguments) {
    machine_.paint_stack();
    const CallResult result = machine_.call(function, arguments, budget);
    const std::size_t bytes = machine_.stack_used();
    const auto known =
        std::find_if(uses_.begin(), uses_.end(), [&](const StackUse& use) { return use.function == function; });
    if (known == uses_.end()) {
      uses_.push_back({std::string(function), bytes});
    } else {
      known->bytes = std::max(known->bytes, bytes);
    }
    return result;
  }

  [[nodiscard]] const std::vector<StackUse>& uses() const { return uses_; }

 private:
  Machine& machine_;
  std::vector<StackUse> uses_;
};

/// Contacts that change with the ticks.
std::uint32_t contacts_of(std::uint32_t joint, unsigned tick) { return (tick + joint) % 4; }

}  // namespace

MeasuredJoint deciding_joint(const std::array<std::int32_t, 6>& features) {
  const Declaration& selector = find_algorithm("SensingModule_gait_selector")->declaration();
  MeasuredJoint measured{0, {}};
  const auto set = [&](const std::string& name, std::int32_t value) {
    measured.parameters.emplace_back(static_cast<std::uint32_t>(find_parameter(selector, name)), value);
  };
  const std::int32_t lowest = raw(Unit::ratio, -7);  // every feature is above it
  // Set 2 is chosen, after the first conditions of the others held, and their second ones, "below", did not.
  for (std::size_t rule = 0; rule < 3; ++rule) {
    const std::string number = std::to_string(rule + 2);
    set("feature_" + number, features.at(2 * rule));
    set("threshold_" + number, lowest);
    set("second_feature_" + number, rule == 0 ? features.at(1) : -features.at(2 * rule + 1));
    set("second_threshold_" + number, lowest);
  }
  return measured;
}

TickCost measure_tick(Machine& machine, std::uint8_t algorithm_id, unsigned ticks, const MeasuredJoint& measured) {
  Modules modules(machine, algorithm_id);
  modules.set(measured);
  Statistics set_contacts;
  Statistics receive;
  Statistics advance;
  Statistics total;
  static_cast<void>(modules.exchange(measured.joint));
  const unsigned not_measured = measured.parameters.empty() ? 0 : 1;  // in it the parameters come into force
  for (unsigned tick = 0; tick < ticks + not_measured; ++tick) {
    std::uint64_t contacts_cost = 0;
    std::uint64_t advance_cost = 0;
    for (std::uint32_t joint = 0; joint < joint_count; ++joint) {
      const std::uint64_t contacts =
          modules.call("proleg::Kernel::set_contacts", joint, {joint, contacts_of(joint, tick)}).instructions;
      static_cast<void>(machine.call("benchmark_set_readings", {joint, tick}, budget));
      const std::uint64_t step = modules.call("proleg::Kernel::advance", joint, {}).instructions;
      if (joint == measured.joint) {
        contacts_cost = contacts;
        advance_cost = step;
      }
    }
    const std::uint64_t receive_cost = modules.exchange(measured.joint);
    if (tick < not_measured) {
      continue;
    }
    set_contacts.add(contacts_cost);
    receive.add(receive_cost);
    advance.add(advance_cost);
    total.add(contacts_cost + receive_cost + advance_cost);
  }
  return {set_contacts.result(), receive.result(), advance.result(), total.result()};
}

Instructions measure_whole_tick(Machine& machine, std::uint8_t algorithm_id, unsigned ticks) {
  Modules modules(machine, algorithm_id);
  Statistics statistics;
  static_cast<void>(modules.exchange());
  const auto for_others = [](auto action) {
    for (std::uint32_t joint = 0; joint < joint_count; ++joint) {
      if (joint != measured_joint) {
        action(joint);
      }
    }
  };
  for (unsigned tick = 0; tick < ticks; ++tick) {
    for_others([&](std::uint32_t joint) {
      static_cast<void>(modules.call("proleg::Kernel::set_contacts", joint, {joint, contacts_of(joint, tick)}));
      static_cast<void>(modules.call("proleg::Kernel::advance", joint, {}));
    });
    const std::vector<std::uint32_t> arguments{measured_joint, contacts_of(measured_joint, tick)};
    statistics.add(machine.call("benchmark_tick", arguments, budget).instructions);
    for_others([&](std::uint32_t joint) { static_cast<void>(modules.receive_all(joint)); });
  }
  return statistics.result();
}

Instructions measure_sine(Machine& machine) {
  Statistics statistics;
  constexpr std::uint32_t stride = 0x0010'0001;
  std::uint32_t phase = 0;
  for (int i = 0; i < 4096; ++i) {
    statistics.add(machine.call("proleg::sine", {phase}, budget).instructions);
    phase += stride;
  }
  return statistics.result();
}

std::vector<StackUse> measure_stack(Machine& machine) {
  StackMeter meter(machine);
  for (std::size_t i = 0; i < algorithm_count(); ++i) {
    const std::uint8_t id = algorithm_at(i).declaration().id;
    Modules modules(machine, id);
    const std::uint32_t kernel = modules.kernel(measured_joint);
    const std::uint32_t configuration = machine.call("benchmark_configuration", {id}, budget).value;
    meter.call("proleg::Kernel::configure", {kernel, configuration, measured_joint});
    meter.call("proleg::Kernel::reset", {kernel});
    static_cast<void>(modules.exchange());

    // A tick with a commit, and one in which every frame of the others is missing.
    constexpr std::uint32_t transaction = 7;
    constexpr std::uint32_t slot = 0;
    constexpr std::uint32_t parameter = 0;
    constexpr std::uint32_t value = 1;
    meter.call("proleg::Kernel::stage", {kernel, transaction, slot, measured_joint, parameter, value});
    meter.call("proleg::Kernel::commit", {kernel, transaction, 0});
    meter.call("proleg::Kernel::advance", {kernel});
    meter.call("proleg::Kernel::advance", {kernel});
    for (std::uint32_t joint = 0; joint < joint_count; ++joint) {
      if (joint != measured_joint) {
        static_cast<void>(modules.call("proleg::Kernel::advance", joint, {}));
        static_cast<void>(modules.call("proleg::Kernel::advance", joint, {}));
        meter.call("proleg::Kernel::receive", {kernel, joint, 0, modules.frame(joint)});
      }
    }
  }
  return meter.uses();
}

Sizes read_sizes(const Machine& machine) {
  return {machine.read_word(machine.address_of("size_of_joint_memory")),
          machine.read_word(machine.address_of("size_of_kernel"))};
}

}  // namespace proleg::cortex_m
