#include "tools/proleg/robot/assign_bus.hpp"

#include <algorithm>
#include <bitset>
#include <exception>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>

#include "shared/computer/master/master_text.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::tools {
namespace {

constexpr Microseconds second = 1'000'000;

}  // namespace

void reset_all(BusAccess& bus) {
  /// Who boots. Two modules with one node id boot, report it once, and stop.
  class BootWatch final : public host::BusUser {
   public:
    void receive(Microseconds /*now*/, const CanFrame& frame) override {
      if (const auto heartbeat = canopen::decode_heartbeat(frame);
          heartbeat && heartbeat->state == canopen::NmtState::boot_up) {
        duplicate = boots.test(heartbeat->node) ? heartbeat->node : duplicate;
        boots.set(heartbeat->node);
      } else if (const auto emergency = canopen::decode_emergency(frame);
                 emergency && emergency->code == canopen::EmergencyCode::identifier_collision) {
        duplicate = emergency->node;
      }
    }
    std::bitset<128> boots;
    std::uint8_t duplicate = 0;
  };
  constexpr Microseconds boot_time = 400'000;
  bus.wait_for("room for a frame", second, [&bus] {
    return bus.connection().send(canopen::encode(canopen::NmtRequest{canopen::NmtCommand::reset_node, 0}));
  });
  BootWatch watch;
  const host::BusAttachment attachment(bus.connection(), watch);
  bus.connection().run_for(boot_time);
  if (watch.duplicate != 0) {
    throw std::runtime_error("two modules have the node id " + std::to_string(watch.duplicate) +
                             ", and have stopped; run 'proleg recover', which gives one of them another node id, then "
                             "proleg assign again");
  }
}

ModulesToNumber find_modules_to_number(BusAccess& bus) {
  host::BusScan all(bus.connection());
  scan(bus, all);
  ModulesToNumber found;
  for (const host::ScannedNode& node : all.nodes()) {
    if (!node.is_module) {
      found.others.push_back(node.node);
      continue;
    }
    const canopen::LssAddress address{node.vendor, node.product, node.revision, node.serial};
    if (std::ranges::find(found.modules, address, &host::PlacedModule::address) != found.modules.end()) {
      throw std::runtime_error("two modules have the serial number " + hexadecimal(node.serial, 8) +
                               "; only one of them can be on the bus while node ids are given");
    }
    found.modules.push_back({node.node, address, std::nullopt});
  }
  if (found.modules.empty()) {
    throw std::runtime_error("found no joint module on the bus; " + bus.connection().diagnosis());
  }
  return found;
}

MovingJoint::MovingJoint(BusAccess& bus, std::uint8_t node, const host::JointMotionOptions& options)
    : bus_(bus), motion_(bus.connection(), node, options), attachment_(bus.connection(), motion_) {
  using State = host::JointMotion::State;
  constexpr Microseconds longest = 60 * second;  // it ends by itself; this bounds one with a fault
  try {
    motion_.start(bus_.connection().now());
    bus_.wait_for("the joint to move", longest, [this] {
      take_events();
      return motion_.state() == State::moving || motion_.state() == State::failed;
    });
    if (motion_.state() == State::failed) {
      throw std::runtime_error(problem() + "; " + bus_.connection().diagnosis());
    }
  } catch (...) {
    stop_after_failure();
    throw;
  }
}

MovingJoint::~MovingJoint() {
  if (!is_off_) {
    stop_after_failure();
  }
}

void MovingJoint::take_events() {
  while (const auto event = motion_.take_event()) {
    is_confirmed_ = is_confirmed_ && event->kind != canopen::EventKind::not_stopped;
  }
}

std::string MovingJoint::problem() const {
  return problem_text(motion_.problem(), [](std::uint8_t node) { return "node " + std::to_string(node); });
}

bool MovingJoint::try_to_stop() {
  constexpr Microseconds longest = 20 * second;
  host::BusConnection& bus = bus_.connection();
  motion_.stop(bus.now());
  const bool is_stopped = bus.run_until(bus.now() + longest, [this] {
    take_events();
    return motion_.state() == host::JointMotion::State::stopped;
  });
  is_off_ = is_stopped && is_confirmed_ && motion_.lost_events() == 0;
  return is_off_;
}

void MovingJoint::stop_after_failure() noexcept {
  bool is_off = false;
  try {
    is_off = try_to_stop();
  } catch (const std::exception& error) {
    std::cerr << "proleg assign: " << error.what() << '\n';
  }
  if (!is_off) {
    std::cerr << "proleg assign: the module has not confirmed that its servo has no power: switch the robot off\n";
  }
}

void MovingJoint::stop() {
  if (!try_to_stop()) {
    is_off_ = true;  // once is enough
    throw std::runtime_error("the module has not confirmed that its servo has no power: switch the robot off");
  }
}

}  // namespace proleg::tools
