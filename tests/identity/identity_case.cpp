#include "tests/identity/identity_case.hpp"

#include "shared/gait/registry.hpp"
#include "shared/kernel/servo_pulses.hpp"
#include "tests/identity/sensing_probe.hpp"

namespace proleg::identity {
namespace {

struct Change {
  unsigned slot;
  unsigned joint;
  unsigned parameter;
  std::int32_t value;
};

/// Changes staged before one tick that take effect at it or at a later one.
struct Commit {
  std::uint32_t staged_before;
  std::uint32_t tick;
  std::array<Change, 6> changes;
};

struct Distortion {
  std::uint32_t tick;
  unsigned slot;
  unsigned joint;
  unsigned internal_value;
  std::int32_t value;
};

/// Draws the events of a case. Every draw is a separate statement: within one expression C++ does not fix the order,
/// and two compilers would play different cases.
class Dice {
 public:
  explicit Dice(Pcg32 noise) : noise_(noise) {}

  std::uint32_t below(std::uint32_t bound) { return noise_.below(bound); }
  bool one_in(std::uint32_t chance) { return noise_.below(chance) == 0; }
  std::uint32_t any_bits() { return noise_.next(); }

  /// Uniform over the range, and now and then exactly one of its ends.
  std::int32_t within(std::int32_t minimum, std::int32_t maximum) {
    if (one_in(8)) {
      return one_in(2) ? minimum : maximum;
    }
    const std::uint32_t width = static_cast<std::uint32_t>(maximum) - static_cast<std::uint32_t>(minimum);
    const std::uint32_t distance = width == 0xFFFFFFFFU ? noise_.next() : noise_.below(width + 1);
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(minimum) + distance);
  }

  JointMask group() {
    const std::uint32_t all = (1U << joint_count) - 1;
    return JointMask(one_in(3) ? 1 + noise_.below(all) : all);
  }

 private:
  Pcg32 noise_;
};

/// One case in progress.
class Run {
 public:
  Run(std::span<Kernel* const> kernels, const ActuationModule& algorithm, std::uint32_t number)
      : kernels_(kernels),
        algorithm_(algorithm),
        dice_(Pcg32(number, algorithm.declaration().id)),
        measured_(Pcg32(number, readings_stream)) {}

  void prepare() {
    configure();
    if (status_ != Status::ok) {
      return;
    }
    for (unsigned joint = 0; joint < joint_count; ++joint) {
      set_up_joint(joint);
    }
    for (std::uint32_t i = 0; i < commits_.size(); ++i) {
      // The second is staged after the first has taken effect at the latest possible tick.
      draw_commit(i * (tick_count / 2), commits_[i]);
    }
    draw_distortion();
    set_up_servos();
    for (Kernel* kernel : kernels_) {
      kernel->reset();
    }
  }

  void play(const FaultInjection& fault, Trace& trace) {
    exchange(fault);
    for (std::uint32_t tick = 0; tick < tick_count; ++tick) {
      change_parameters(tick);
      if (tick == distortion_.tick) {
        distort();
      }
      touch();
      measure();
      for (Kernel* kernel : kernels_) {
        kernel->advance();
      }
      exchange(fault);
      read(tick, trace);
    }
    trace.missed_frames = 0;
    for (const Kernel* kernel : kernels_) {
      trace.missed_frames += kernel->missed_frames();
    }
  }

  [[nodiscard]] Status status() const { return status_; }

 private:
  static constexpr std::uint32_t never = 0xFFFFFFFFU;
  static constexpr std::uint32_t max_wait = 50;
  static constexpr std::uint64_t readings_stream = 1'000;  // beyond the ids of algorithms
  static constexpr std::uint32_t servo_period_us = 2'500;

  void expect_ok(Status status) {
    if (status_ == Status::ok) {
      status_ = status;
    }
  }

  [[nodiscard]] Kernel& kernel_of(unsigned joint) const {
    return kernels_.size() == 1 ? *kernels_[0] : *kernels_[joint];
  }

  void configure() {
    // Not the registry, so that a new algorithm does not change the cases of the others.
    constexpr std::array<std::uint8_t, 5> companions{1, 2, 3, 4, 127};
    configuration_.joint_count = joint_count;
    if (dice_.one_in(4)) {
      configuration_.tick_period_us = 1'000 + dice_.below(99'001);
    }
    configuration_.seed = dice_.below(1'000'000);
    const unsigned first = dice_.below(max_slots);
    configuration_.slots[first] = {&algorithm_, dice_.group()};
    if (dice_.one_in(3)) {
      const unsigned second = (first + 1 + dice_.below(max_slots - 1)) % max_slots;
      const ActuationModule* companion = find_algorithm(companions[dice_.below(companions.size())]);
      configuration_.slots[second] = {companion, dice_.group()};
    }
    unsigned first_joint = 0;
    for (Kernel* kernel : kernels_) {
      expect_ok(kernel->configure(configuration_, first_joint));
      first_joint += kernel->local_joint_count();
    }
  }

  void set_up_joint(unsigned joint) {
    Kernel& kernel = kernel_of(joint);
    for (unsigned slot = 0; slot < max_slots; ++slot) {
      if (!kernel.drives(slot, joint)) {
        continue;
      }
      const std::span<const Parameter> parameters = configuration_.slots[slot].algorithm->declaration().parameters;
      for (unsigned i = 0; i < parameters.size(); ++i) {
        const std::int32_t value = dice_.within(parameters[i].minimum, parameters[i].maximum);
        expect_ok(kernel.set_parameter(slot, joint, i, value));
      }
    }
    if (dice_.one_in(6)) {
      const std::int32_t lower = dice_.within(-quarter_turn, quarter_turn);
      expect_ok(kernel.set_limits(joint, lower, dice_.within(lower, quarter_turn)));
    }
  }

  void set_up_servos() {
    const std::uint32_t speed = min_command_speed + static_cast<std::uint32_t>(configuration_.seed) % 2'000U;
    for (MotionLimiter& limiter : limiters_) {
      limiter.set_step(MotionLimiter::step_of(speed, servo_period_us));
    }
  }

  /// A slot and a joint that it drives.
  void draw_target(unsigned& slot, unsigned& joint) {
    do {
      slot = dice_.below(max_slots);
      joint = dice_.below(joint_count);
    } while (!kernel_of(joint).drives(slot, joint));
  }

  void draw_commit(std::uint32_t earliest, Commit& commit) {
    commit.staged_before = earliest + dice_.below(tick_count / 2 - max_wait);
    commit.tick = commit.staged_before + dice_.below(max_wait);
    for (Change& change : commit.changes) {
      draw_target(change.slot, change.joint);
      const std::span<const Parameter> parameters =
          configuration_.slots[change.slot].algorithm->declaration().parameters;
      change.parameter = dice_.below(static_cast<std::uint32_t>(parameters.size()));
      const Parameter& parameter = parameters[change.parameter];
      change.value = dice_.within(parameter.minimum, parameter.maximum);
    }
    if (dice_.one_in(4)) {
      commit.staged_before = never;
    }
  }

  void draw_distortion() {
    draw_target(distortion_.slot, distortion_.joint);
    const std::size_t values = configuration_.slots[distortion_.slot].algorithm->declaration().internal_values.size();
    distortion_.tick = values == 0 ? never : dice_.below(tick_count);
    distortion_.internal_value = values == 0 ? 0 : dice_.below(static_cast<std::uint32_t>(values));
    distortion_.value = static_cast<std::int32_t>(dice_.any_bits());
  }

  void change_parameters(std::uint32_t tick) {
    for (std::uint16_t transaction = 0; transaction < commits_.size(); ++transaction) {
      const Commit& commit = commits_[transaction];
      if (commit.staged_before != tick) {
        continue;
      }
      for (const Change& change : commit.changes) {
        expect_ok(
            kernel_of(change.joint).stage(transaction, change.slot, change.joint, change.parameter, change.value));
      }
      for (Kernel* kernel : kernels_) {
        // The commit is broadcast: a module without a change receives it too and has nothing staged.
        const Status status = kernel->commit(transaction, commit.tick);
        if (status != Status::nothing_staged) {
          expect_ok(status);
        }
      }
    }
  }

  void distort() {
    constexpr std::uint16_t transaction = 100;
    Kernel& kernel = kernel_of(distortion_.joint);
    expect_ok(kernel.stage_internal(transaction, distortion_.slot, distortion_.joint, distortion_.internal_value,
                                    distortion_.value));
    expect_ok(kernel.commit(transaction, distortion_.tick));
  }

  void touch() {
    std::uint32_t contacts = dice_.any_bits();
    for (unsigned joint = 0; joint < joint_count; ++joint) {
      // Only the head module has sensors in front of its joint.
      const unsigned sensors = joint == 0 ? 4 : 2;
      kernel_of(joint).set_contacts(joint, static_cast<std::uint8_t>(contacts & ((1U << sensors) - 1)));
      contacts >>= sensors;
    }
  }

  /// Now and then a sensor is absent.
  void measure() {
    for (unsigned joint = 0; joint < joint_count; ++joint) {
      JointReadings readings;
      readings.present = static_cast<std::uint8_t>(measured_.any_bits() & JointReadings::all_sensors);
      readings.current_ma = static_cast<std::int32_t>(measured_.any_bits() >> 17U);
      readings.pitch = static_cast<std::int32_t>(measured_.any_bits());
      readings.roll = static_cast<std::int32_t>(measured_.any_bits());
      for (std::int32_t& axis : readings.acceleration_mm_s2) {
        axis = static_cast<std::int32_t>(measured_.any_bits());
      }
      readings.angle = static_cast<std::int32_t>(measured_.any_bits());
      kernel_of(joint).set_readings(joint, readings);
    }
  }

  void exchange(const FaultInjection& fault) {
    if (kernels_.size() == 1) {
      return;
    }
    for (unsigned sender = 0; sender < joint_count; ++sender) {
      const Kernel& source = *kernels_[sender];
      const unsigned channels = source.channel_count(sender);
      for (unsigned channel = 0; channel < channels; ++channel) {
        const StateFrame& frame = source.frame(sender, channel);
        for (unsigned receiver = 0; receiver < joint_count; ++receiver) {
          if (receiver == sender) {
            continue;
          }
          if (fault.fault != Fault::none && sender == fault.sender && receiver == fault.receiver) {
            deliver_with_fault(fault, sender, channel, frame, *kernels_[receiver]);
          } else {
            static_cast<void>(kernels_[receiver]->receive(sender, channel, frame));
          }
        }
      }
    }
  }

  void deliver_with_fault(const FaultInjection& fault, unsigned sender, unsigned channel, const StateFrame& frame,
                          Kernel& receiver) {
    StateFrame delivered = frame;
    if (receiver.tick() == fault.tick) {
      if (fault.fault == Fault::dropped_frame) {
        return;
      }
      if (fault.fault == Fault::late_frame) {
        held_back_[channel] = frame;
        return;
      }
      delivered.bytes[6] = static_cast<std::uint8_t>((frame.bytes[6] & ~StateFrame::contact_bits) |
                                                     (held_back_[channel].bytes[6] & StateFrame::contact_bits));
    } else if (fault.fault == Fault::late_frame && receiver.tick() == fault.tick + 1) {
      static_cast<void>(receiver.receive(sender, channel, held_back_[channel]));
    }
    held_back_[channel] = frame;
    static_cast<void>(receiver.receive(sender, channel, delivered));
  }

  void read(std::uint32_t tick, Trace& trace) {
    const std::uint32_t elapsed_us = configuration_.tick_period_us / 16 * (dice_.any_bits() >> 28U);
    const std::int32_t fraction = sample_fraction(elapsed_us, servo_period_us, configuration_.tick_period_us);
    for (unsigned joint = 0; joint < joint_count; ++joint) {
      const Kernel& kernel = kernel_of(joint);
      const std::size_t position = std::size_t{tick} * joint_count + joint;
      trace.setpoints[position] = kernel.setpoint(joint);
      const std::int32_t angle = interpolate(kernel.previous_setpoint(joint), kernel.setpoint(joint), fraction);
      trace.servo_commands[position] = servo_command(limiters_[joint].next(angle));
    }
  }

  std::span<Kernel* const> kernels_;
  const ActuationModule& algorithm_;
  Dice dice_;
  Dice measured_;  ///< apart, so that the readings change nothing in the cases of algorithms that use none
  KernelConfiguration configuration_;
  std::array<Commit, 2> commits_;
  Distortion distortion_;
  std::array<StateFrame, max_channels> held_back_{};
  std::array<MotionLimiter, joint_count> limiters_;
  Status status_ = Status::ok;
};

}  // namespace

const ActuationModule* find_algorithm(std::uint8_t id) {
  for (const ActuationModule* probe : {static_cast<const ActuationModule*>(&sensing_probe()), &reading_probe()}) {
    if (id == probe->declaration().id) {
      return probe;
    }
  }
  return proleg::find_algorithm(id);
}

std::array<Kernel*, joint_count> Modules::kernels() {
  std::array<Kernel*, joint_count> pointers;
  for (std::size_t i = 0; i < joint_count; ++i) {
    pointers[i] = &kernels_[i];
  }
  return pointers;
}

Status run(std::span<Kernel* const> kernels, const ActuationModule& algorithm, std::uint32_t number,
           const FaultInjection& fault, Trace& trace) {
  Run run(kernels, algorithm, number);
  run.prepare();
  if (run.status() == Status::ok) {
    run.play(fault, trace);
  }
  return run.status();
}

}  // namespace proleg::identity
