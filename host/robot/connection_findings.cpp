// Finds faults of the connection of this computer to a bus.

#include <algorithm>
#include <array>

#include "host/robot/findings.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::host {
namespace {

constexpr std::uint32_t bit_rate = 1'000'000;
/// Shortest useful queue: a scan has 32 requests under way at the same time.
constexpr std::uint32_t shortest_queue = 32;

std::string set_up_command(const std::string& interface) {
  return "sudo ip link set " + interface + " up type can bitrate 1000000";
}

std::string set_up_again(const std::string& interface) {
  return "sudo ip link set " + interface + " down; " + set_up_command(interface);
}

Finding interface_down(const std::string& name, const std::optional<CanInterface>& can) {
  const bool is_virtual = can && can->kind == "vcan";
  return {"interface_down",
          "The CAN interface " + name + " is down.",
          is_virtual ? "sudo ip link set " + name + " up" : set_up_command(name),
          {}};
}

Finding no_rights(const ConnectionFacts& facts, const std::string& name) {
  const std::string group = facts.serial ? facts.serial->group : "dialout";
  const bool is_member = facts.serial && facts.serial->is_user_in_group;
  return {"no_rights",
          "This user may not use " + name + (facts.serial ? ", which belongs to the group " + group + "." : "."),
          (is_member || group == "root" ? std::string("Install")
                                        : "sudo usermod -aG " + group + " $USER, and log in again. Or install") +
              " the udev rules 70-proleg.rules (docs/installing.md), and plug the adapter in again.",
          {}};
}

Finding in_use(const ConnectionFacts& facts, const std::string& name) {
  const bool is_known = facts.serial && !facts.serial->programs.empty();
  return {
      "device_in_use",
      name + " is in use by another program" + (is_known ? ": " + listed(facts.serial->programs) : std::string()) + ".",
      std::string("End that program") + (is_known ? "" : " (sudo fuser -v " + name + " shows which it is)") +
          ". ModemManager opens new adapters by itself: the udev rules 70-proleg.rules (docs/installing.md) keep it "
          "away.",
      {}};
}

Finding missing(const BusAddress& address) {
  if (address.kind == BusAddress::Kind::can) {
    return {
        "no_interface",
        "This computer has no CAN interface " + address.name + ".",
        "Plug the adapter in. ip -brief link show type can lists the interfaces that there are; an slcan adapter is a "
        "serial line: --bus serial:/dev/ttyUSB0.",
        {}};
  }
  return {"no_device",
          "There is no device " + address.name + ".",
          "Plug the adapter in. ls /dev/serial/by-id /dev/ttyUSB* /dev/ttyACM* shows the devices that there are.",
          {}};
}

Finding wrong_kind(const BusAddress& address) {
  if (address.kind == BusAddress::Kind::can) {
    return {"wrong_kind",
            "The network interface " + address.name + " is no CAN interface.",
            "ip -brief link show type can lists the CAN interfaces: name one of them.",
            {}};
  }
  return {"wrong_kind",
          address.name + " is no serial line.",
          "ls /dev/serial/by-id /dev/ttyUSB* /dev/ttyACM* shows the serial lines: name one of them.",
          {}};
}

/// The part of an error's text behind the address.
std::string cause_of(const std::string& text, const std::string& address) {
  const std::string head = address + ": ";
  return text.starts_with(head) ? text.substr(head.size()) : text;
}

std::string advice_for_silence(const BusAddress& address) {
  switch (address.kind) {
    case BusAddress::Kind::serial:
      return "Check that the robot or the adapter has power, that RX and TX are not exchanged, and the baud rate: " +
             std::string("modules have 1000000, other adapters often 115200 (--bus serial:") + address.name +
             "@115200).";
    case BusAddress::Kind::bluetooth:
      return "Check that the robot has power and is near, and that the baud rate of its Bluetooth module is 1000000.";
    default:
      return "Check that the program or device at the other end speaks slcan (docs/adapters.md), and that it runs.";
  }
}

Finding explain(const ConnectionFacts& facts) {
  const ConnectionFacts::Failure& failure = *facts.failure;
  const std::string address = bus_address_text(facts.address);
  const std::string cause = shortened(one_line(cause_of(failure.text, address)), 160);
  switch (failure.problem) {
    case TransportProblem::no_kernel_support:
      return {
          "kernel_without_can",
          "The kernel of this computer has no CAN.",
          "sudo modprobe can-raw. If there is no such module, install the kernel's package of additional modules; or "
          "use an slcan adapter, which needs none: --bus serial:/dev/ttyUSB0.",
          {}};
    case TransportProblem::missing:
      return missing(facts.address);
    case TransportProblem::wrong_kind:
      return wrong_kind(facts.address);
    case TransportProblem::interface_down:
      return interface_down(facts.address.name, facts.can);
    case TransportProblem::no_rights:
      return no_rights(facts, facts.address.name);
    case TransportProblem::in_use:
      return in_use(facts, facts.address.name);
    case TransportProblem::no_answer:
      return {
          "adapter_silent", "The adapter at " + address + " does not answer.", advice_for_silence(facts.address), {}};
    case TransportProblem::not_slcan:
      return {"adapter_not_slcan",
              "What answers at " + address + " is no slcan adapter, or the baud rate is wrong (" + cause + ").",
              advice_for_silence(facts.address),
              {}};
    case TransportProblem::no_bit_rate:
      return {"adapter_refuses",
              "The adapter at " + address + " does not open its channel with 1 Mbit/s (" + cause + ").",
              "Unplug the adapter and plug it in again. If that does not help, it needs another program, or another "
              "adapter is needed: the bus has 1 Mbit/s.",
              {}};
    case TransportProblem::no_listener:
    case TransportProblem::other:
      break;
  }
  return {"bus_not_reached",
          address + " cannot be reached: " + cause + ".",
          facts.address.kind == BusAddress::Kind::tcp
              ? "Start the program that serves the bus, such as proleg bus, or check host and port."
          : facts.address.kind == BusAddress::Kind::bluetooth
              ? "Switch the robot on, bring it near, and pair it: bluetoothctl pair, then trust."
          : facts.address.kind == BusAddress::Kind::serial
              ? "Name a baud rate that both ends have: --bus serial:" + facts.address.name + "@115200."
              : "Check the address: docs/robot-on-the-table.md lists what --bus can be.",
          {}};
}

void add_interface_faults(std::vector<Finding>& findings, const std::string& name, const CanInterface& can) {
  if (!can.is_can) {
    findings.push_back(wrong_kind({BusAddress::Kind::can, name, 0, {}}));
    return;
  }
  if (!can.is_up) {
    findings.push_back(interface_down(name, can));
    return;
  }
  if (can.bit_rate && *can.bit_rate != bit_rate) {
    findings.push_back(
        {"interface_bit_rate",
         name + " is set to " + std::to_string(*can.bit_rate) + " bit/s. The bus of the robot has 1000000 bit/s.",
         set_up_again(name),
         {}});
  }
  if (can.is_listen_only) {
    findings.push_back({"listen_only",
                        name + " only listens: it neither sends frames nor acknowledges those of the modules.",
                        set_up_again(name) + " listen-only off",
                        {}});
  }
  if (can.state == CanState::bus_off && can.restart_ms.value_or(0) == 0) {
    findings.push_back({"bus_off",
                        name + " has switched itself off after too many errors on the wires (bus-off).",
                        "Check cable, connectors and both terminators (120 ohms at each end), then " +
                            set_up_again(name) + " restart-ms 100. With restart-ms the interface returns by itself.",
                        {}});
  }
  if (can.queue_length && *can.queue_length < shortest_queue) {
    findings.push_back({"short_queue",
                        "Only " + std::to_string(*can.queue_length) + " frames can wait in " + name +
                            "; a burst of requests needs more, and the rest is refused.",
                        "sudo ip link set " + name + " txqueuelen 1000",
                        {}});
  }
}

void add_device_faults(std::vector<Finding>& findings, const ConnectionFacts& facts) {
  const SerialDevice& device = *facts.serial;
  if (!device.exists) {
    findings.push_back(missing(facts.address));
  } else if (!device.may_use) {
    findings.push_back(no_rights(facts, facts.address.name));
  } else if (!device.is_character_device) {
    findings.push_back(wrong_kind(facts.address));
  }
}

}  // namespace

std::vector<Finding> find_connection_faults(const ConnectionFacts& facts) {
  std::vector<Finding> findings;
  if (facts.can) {
    add_interface_faults(findings, facts.address.name, *facts.can);
  }
  if (facts.serial) {
    add_device_faults(findings, facts);
  }
  if (facts.failure && std::ranges::none_of(findings, blocks)) {
    findings.insert(findings.begin(), explain(facts));
  }
  return findings;
}

bool blocks(const Finding& finding) { return finding.code != "short_queue"; }

}  // namespace proleg::host
