#include "shared/canopen/objects.hpp"
#include "shared/canopen/power_state.hpp"
#include "shared/computer/master/master.hpp"

// The SDO transfers of each phase, and how the master handles their results.

namespace proleg::canopen {
namespace {

/// Entries that are read from each module before it is set up.
constexpr const Object* identity_entries[] = {&object::vendor, &object::product, &object::serial, &object::version,
                                              &object::core_fingerprint};
constexpr std::size_t identity_count = 5;

/// Controlwords that enable a drive, in their order.
constexpr std::uint16_t enabling_controlwords[] = {shutdown_controlword, switch_on_controlword,
                                                   enable_operation_controlword};
constexpr std::size_t enabling_count = 3;

bool is_user_slot(const Slot& slot) {
  return slot.algorithm != nullptr && is_user_algorithm(slot.algorithm->declaration().id);
}

}  // namespace

std::optional<SdoRequest> Master::request(unsigned joint, std::size_t position) {
  const auto write = [](const Object& object, std::uint32_t value) {
    return SdoRequest{object.address, size_of(object.type), value};
  };
  const auto only = [&](const Object& object, std::uint32_t value) {
    return position == 0 ? std::optional(write(object, value)) : std::nullopt;
  };
  switch (phase_) {
    case Phase::set_up:
      return set_up_request(joint, position);
    case Phase::stage:
      return plan_.staging(change_, joint, position);
    case Phase::enable:
      if (position < enabling_count) {
        return write(object::controlword, enabling_controlwords[position]);
      }
      // A late answer may have confirmed the next request, which was lost.
      return position == enabling_count && options_.attempts > 1 ? std::optional(SdoRequest{object::statusword.address})
                                                                 : std::nullopt;
    case Phase::produce_sync:
      return only(object::sync_identifier, produces_sync | identifier::sync);
    case Phase::ramp:
      return only(object::controlword, quick_stop_controlword);
    case Phase::take_lease:
    case Phase::keep_lease:
      return lease_request(position);
    case Phase::set_ramp_in:
    case Phase::ramp_in:
      return ramp_in_request(joint, position);
    case Phase::hold:
      return hold_request(joint, position);
    case Phase::ramping:
      return checksum_request(position);
    case Phase::disable:
      // The host leaves, so its silence must be no error. (In the loop the modules are not used again.)
      return position == 1 && options_.resets_modules ? std::optional(write(object::host_heartbeat, 0))
                                                      : only(object::controlword, 0);
    case Phase::sync_off:
      return only(object::sync_identifier, identifier::sync);
    default:
      return std::nullopt;
  }
}

std::optional<SdoRequest> Master::set_up_request(unsigned joint, std::size_t position) const {
  if (position < identity_count) {
    return SdoRequest{identity_entries[position]->address};
  }
  position -= identity_count;
  const std::size_t users = user_algorithm_count();
  if (position < users) {
    return SdoRequest{object::user_algorithm_address(user_algorithm(position).id)};
  }
  position -= users;
  const SetupList list(setup_, joint);
  if (position < list.size()) {
    return list.at(position);
  }
  if (position == list.size()) {
    return SdoRequest{object::configuration_crc.address};
  }
  return mission_ == Mission::rejoin ? plan_.parameter_write(rejoin_from_, joint, position - list.size() - 1)
                                     : std::nullopt;
}

/// Number of slots of the robot with users' algorithms.
std::size_t Master::user_algorithm_count() const {
  std::size_t count = 0;
  for (const Slot& slot : setup_.kernel.slots) {
    count += is_user_slot(slot) ? 1U : 0U;
  }
  return count;
}

/// Declaration of a user's algorithm. position: below user_algorithm_count().
const Declaration& Master::user_algorithm(std::size_t position) const {
  const Slot* slot = setup_.kernel.slots.data();
  while (!is_user_slot(*slot) || position-- > 0) {
    ++slot;
  }
  return slot->algorithm->declaration();
}

/// The requests before the servos have power: whether the module measures its angle, and its speed. The requests
/// afterwards: the angle.
std::optional<SdoRequest> Master::ramp_in_request(unsigned joint, std::size_t position) const {
  if (!ramping_in_.contains(joint)) {
    return std::nullopt;
  }
  if (phase_ == Phase::ramp_in) {
    return SdoRequest{object::statusword.address};
  }
  const Object& speed = object::ramp_in_speed;
  switch (position) {
    case 0:
      return SdoRequest{object::capabilities.address};
    case 1:
      return SdoRequest{speed.address, size_of(speed.type), options_.ramp_in_speed};
    default:
      return std::nullopt;
  }
}

/// The requests with which a joint holds its angle. The mode comes first: with it the module drops the target that it
/// had.
std::optional<SdoRequest> Master::hold_request(unsigned joint, std::size_t position) const {
  const auto write = [](const Object& object, std::uint32_t value) {
    return SdoRequest{object.address, size_of(object.type), value};
  };
  const bool is_measured = measured_[joint] != static_cast<std::uint32_t>(position_not_measured);
  switch (position) {
    case 0:
      return write(object::mode, static_cast<std::uint8_t>(mode_direct_position));
    case 1:
      return SdoRequest{object::actual_position.address};
    case 2:
      return is_measured ? std::optional(write(object::target_position, measured_[joint])) : std::nullopt;
    default:
      return std::nullopt;
  }
}

/// The requests for a checksum. The request to take the pair of values comes before both reads, also if a read is
/// repeated: the values belong together.
std::optional<SdoRequest> Master::checksum_request(std::size_t position) const {
  const Object& ticks = object::setpoint_ticks;
  switch (position) {
    case 0:
      return SdoRequest{ticks.address, size_of(ticks.type), 0};
    case 1:
      return SdoRequest{ticks.address};
    case 2:
      return SdoRequest{object::setpoint_crc.address};
    default:
      return std::nullopt;
  }
}

void Master::on_checksum(unsigned joint, std::size_t position, std::uint32_t value) {
  SetpointChecksum& checksum = checksums_[joint];
  if (position == 1) {
    checksum.ticks = value;
  } else {
    checksum.crc = value;
    checksum.state = SetpointChecksum::State::read;
  }
}

bool Master::on_value(unsigned joint, std::size_t position, std::uint32_t value) {
  if (phase_ == Phase::take_lease || phase_ == Phase::keep_lease) {
    return on_lease(joint, value);
  }
  if (phase_ == Phase::ramping) {
    on_checksum(joint, position, value);
    return true;
  }
  if (phase_ == Phase::hold) {
    measured_[joint] = value;
    return true;
  }
  Identity& identity = identities_[joint];
  const auto expect = [&](std::uint32_t expected, ProblemCode code) {
    if (value == expected) {
      return true;
    }
    Problem problem = problem_of(code, joint);
    problem.found = value;
    problem.expected = expected;
    return joint_failed(problem);
  };
  if (phase_ == Phase::set_ramp_in || phase_ == Phase::ramp_in) {
    const bool is_done = phase_ == Phase::ramp_in ? (value & target_reached) != 0 : (value & measures_angle) == 0;
    ramping_in_ -= is_done ? JointMask::of(joint) : JointMask();
    return true;
  }
  if (phase_ == Phase::enable) {
    value &= drive_state_bits;
    return expect(drive_operation_enabled, ProblemCode::not_enabled);
  }
  const std::uint32_t serial = options_.serials.empty() ? 0 : options_.serials[joint];
  switch (position) {
    case 0:
      identity.vendor = value;
      return true;
    case 1:
      identity.product = value;
      return true;
    case 2:
      identity.serial = value;
      return serial == 0 || expect(serial, ProblemCode::wrong_serial);
    case 3:
      return expect(protocol_version, ProblemCode::wrong_protocol);
    case 4:
      return expect(options_.core_fingerprint, ProblemCode::wrong_fingerprint);
    default:
      if (position - identity_count < user_algorithm_count()) {
        const Declaration& algorithm = user_algorithm(position - identity_count);
        return (value != 0 && value == algorithm.sources) || algorithm_missing(joint, algorithm, value);
      }
      return expect(crc_, ProblemCode::wrong_configuration);
  }
}

void Master::on_abort(unsigned joint, Address address, AbortCode code) {
  if (phase_ == Phase::take_lease || phase_ == Phase::keep_lease) {
    on_lease_abort(joint, address, code);
    return;
  }
  if (phase_ == Phase::ramping) {
    checksums_[joint].state =
        code == AbortCode::no_such_object ? SetpointChecksum::State::not_available : SetpointChecksum::State::not_read;
    return;
  }
  if (phase_ == Phase::set_ramp_in && code == AbortCode::no_such_object) {
    ramping_in_ -= JointMask::of(joint);  // the program of the module is older
    return;
  }
  if (phase_ == Phase::set_up && address.index == object::user_algorithms.index && code != AbortCode::timeout) {
    // The program of the module is older than the object, so it has no algorithms of users.
    for (std::size_t i = 0; i < user_algorithm_count(); ++i) {
      if (object::user_algorithm_address(user_algorithm(i).id) == address) {
        static_cast<void>(algorithm_missing(joint, user_algorithm(i), 0));
        return;
      }
    }
  }
  Problem problem = problem_of(code == AbortCode::timeout ? ProblemCode::no_answer : ProblemCode::refused, joint);
  problem.address = address;
  problem.abort_code = code;
  static_cast<void>(joint_failed(problem));
}

/// Reports that a module has not this algorithm. Always returns false.
bool Master::algorithm_missing(unsigned joint, const Declaration& algorithm, std::uint32_t found) {
  Problem problem = problem_of(ProblemCode::missing_algorithm, joint);
  problem.address = object::user_algorithm_address(algorithm.id);
  problem.found = found;
  problem.expected = algorithm.sources;
  problem.algorithm = algorithm.id;
  return joint_failed(problem);
}

/// Ends the mission for the joint. Always returns false.
bool Master::joint_failed(const Problem& problem) {
  const JointMask self = JointMask::of(problem.joint);
  switch (mission_) {
    case Mission::bring_up:
      fail(problem);
      break;
    case Mission::change:
      if (problem.code == ProblemCode::no_answer) {
        joints_ -= self;
        lost_ |= self;
        add_event(EventKind::not_reached, problem.node);
      } else if (!change_failed_) {
        change_failed_ = true;
        sdo_clients_.cancel_all();
        Problem refused = problem;
        refused.code = ProblemCode::change_refused;
        refused.change = change_;
        report(refused);
      }
      break;
    case Mission::rejoin:
      joints_ -= self;
      lost_ |= self;
      given_up_ |= self;
      add_event(EventKind::rejoin_failed, problem.node, static_cast<std::uint32_t>(problem.code));
      break;
    case Mission::stop:
      if (phase_ == Phase::disable) {
        add_event(EventKind::not_stopped, problem.node);
      }
      break;
    case Mission::none:
      break;
  }
  return false;
}

}  // namespace proleg::canopen
