#include "tools/proleg/describe/object_files.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "shared/canopen/objects.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/registry.hpp"
#include "tools/proleg/describe/dbc_file.hpp"
#include "tools/proleg/describe/dbc_messages.hpp"

namespace proleg::tools {
namespace {

using namespace proleg::canopen;

/// A value that an algorithm broadcasts.
struct BroadcastField {
  std::string name;
  Unit unit;
  unsigned bytes;
  std::string help;

  [[nodiscard]] bool same_place(const BroadcastField& other) const {
    return name == other.name && unit == other.unit && bytes == other.bytes;
  }
};
using Broadcast = std::vector<BroadcastField>;

struct Joint {
  std::uint8_t node;
  std::string name;           ///< name in its messages
  std::string comment;        ///< comment on its node
  bool has_far_link = false;  ///< its frame has the contacts of the link in front, too
  /// Broadcasts by channel; nothing if the frame is not sent.
  std::array<std::optional<Broadcast>, max_channels> broadcasts;
};

// Messages of a joint's module.

DbcMessage emergency_message(const Joint& joint) {
  return {static_cast<std::uint16_t>(identifier::emergency + joint.node),
          joint.name + "_Emergency",
          length_of<Emergency>(),
          joint.name,
          "A fault begins, changes or is over",
          {chosen(member("code", &Emergency::code), emergency_codes()),
           member("error_register", &Emergency::error_register, std::string(object::error_register.help)),
           member("detail", &Emergency::detail, "a tick, a transaction, a joint, ... by the code (docs/protocol.md)")}};
}

/// Adds the signals of a PDO's mapping parameters, in their order.
void add_mapped(DbcMessage& message, std::span<const Object> mapping) {
  unsigned start = 0;
  for (const Object& parameter : mapping) {
    const std::uint32_t mapped = parameter.default_value;
    const Object entry =
        *find_object({static_cast<std::uint16_t>(mapped >> 16U), static_cast<std::uint8_t>(mapped >> 8U)});
    DbcSignal signal = plain(signal_name(entry.name), start, mapped & 0xFFU, std::string(entry.help));
    start += signal.bits;
    signal.is_signed = is_signed(entry.type);
    signal.factor = factor_of(entry.scale);
    signal.unit = unit_of(entry.scale);
    const auto value = [&](std::uint32_t raw) {
      return (signal.is_signed ? static_cast<double>(static_cast<std::int32_t>(raw)) : static_cast<double>(raw)) *
             signal.factor;
    };
    signal.minimum = value(entry.minimum);
    signal.maximum = value(entry.maximum);
    if (entry.address == object::controlword.address) {
      signal.choices = controlwords();
    } else if (entry.address == object::measured_angle.address) {
      signal.choices = {choice(Monitoring::not_measured, "not measured")};
    }
    message.signals.push_back(std::move(signal));
  }
  message.length = start / 8U;
}

DbcMessage command_message(const Joint& joint) {
  DbcMessage message{static_cast<std::uint16_t>(identifier::command + joint.node), joint.name + "_Command", 0, dbc_host,
                     "RPDO1: drive state, and set-point in the mode direct position"};
  add_mapped(message, object::command_mapped);
  set_receiver(message, joint.name);
  return message;
}

DbcMessage monitoring_message(const Joint& joint) {
  DbcMessage message{static_cast<std::uint16_t>(identifier::monitoring + joint.node), joint.name + "_Monitoring", 0,
                     joint.name, "TPDO3: what the module measures, every 10th or 100th tick"};
  add_mapped(message, object::monitoring_mapped);
  set_receiver(message, dbc_host);
  return message;
}

struct FlagText {
  StateFrame::Flag flag;
  const char* name;
  const char* comment;
};
constexpr std::array flags{
    FlagText{StateFrame::contact_rear_link_rear, "contact_rear_link_rear", "link behind the joint, towards the tail"},
    FlagText{StateFrame::contact_rear_link_front, "contact_rear_link_front", "link behind the joint, towards the head"},
    FlagText{StateFrame::contact_far_link_rear, "contact_far_link_rear", "joint 0: link in front, towards the tail"},
    FlagText{StateFrame::contact_far_link_front, "contact_far_link_front", "joint 0: link in front, towards the head"},
    FlagText{StateFrame::fault, "fault", "the drive is in Fault"},
    FlagText{StateFrame::holdover, "holdover", "computed without SYNC, or the first state after joining"},
    FlagText{StateFrame::limited, "limited", "the sum of the slots was cut to the limits of the joint"},
    FlagText{StateFrame::valid, "valid", "bytes 0-5 are a state"},
};

DbcSignal broadcast_signal(const BroadcastField& field, unsigned start) {
  const unsigned bits = 8U * field.bytes;
  const bool is_count = field.unit == Unit::count;  // counts send their low bits, other units the high ones
  DbcSignal signal = plain(field.name, start, bits, field.help);
  signal.is_signed = !is_count;
  signal.factor = factor_of(scale_of(field.unit), is_count ? 0 : 32 - bits);
  signal.unit = unit_of(scale_of(field.unit));
  set_full_range(signal);
  return signal;
}

DbcMessage state_message(const Joint& joint, unsigned channel) {
  const StateFrame none{};
  DbcMessage message{encode_state(joint.node, channel, none).identifier,
                     joint.name + (channel == 0 ? "_State" : "_SecondState"), encode_state(0, 0, none).length,
                     joint.name, "State of the joint at the tick of the label"};
  unsigned start = 0;
  for (const BroadcastField& field : *joint.broadcasts[channel]) {
    message.signals.push_back(broadcast_signal(field, start));
    start += 8U * field.bytes;
  }
  constexpr unsigned flags_start = 8U * StateFrame::payload_size;
  for (const FlagText& text : flags) {
    constexpr unsigned far_contacts =
        static_cast<unsigned>(StateFrame::contact_bits) & ~static_cast<unsigned>(StateFrame::rear_link_contact_bits);
    if ((text.flag & far_contacts) == 0 || joint.has_far_link) {
      const auto bit = static_cast<unsigned>(std::countr_zero(static_cast<unsigned>(text.flag)));
      message.signals.push_back(plain(text.name, flags_start + bit, 1, text.comment));
    }
  }
  message.signals.push_back(plain("label", flags_start + 8, 8, "tick of the state mod 256"));
  return message;
}

void add_messages(DbcFile& file, const Joint& joint) {
  for (unsigned channel = 0; channel < max_channels; ++channel) {
    if (joint.broadcasts[channel]) {
      file.messages.push_back(state_message(joint, channel));
    }
  }
  file.messages.push_back(command_message(joint));
  file.messages.push_back(monitoring_message(joint));
  file.messages.push_back(emergency_message(joint));
  file.messages.push_back(heartbeat_message(joint.node, joint.name));
  set_receiver(file.messages.back(), dbc_host);
  file.messages.push_back(sdo_request_message(joint.node, joint.name));
  file.messages.push_back(sdo_answer_message(joint.node, joint.name));
}

/// joints must be in kernel order; the module of the first one sends SYNC.
void print_dbc(std::ostream& out, const std::vector<Joint>& joints) {
  DbcFile file;
  file.version = "protocol " + std::to_string(protocol_version >> 8U) + "." + std::to_string(protocol_version & 0xFFU);
  file.comment = "Proleg, 1 Mbit/s; written by 'proleg objects --dbc'; docs/protocol.md explains the frames";
  file.nodes.push_back({dbc_host, "node " + std::to_string(host_node)});
  for (const Joint& joint : joints) {
    file.nodes.push_back({joint.name, joint.comment});
  }
  file.tables.push_back({"statusword", statuswords()});
  const std::string& producer = joints.front().name;
  file.messages = {nmt_message(),
                   sync_message(producer),
                   tick_message(producer),
                   commit_message(),
                   heartbeat_message(host_node, dbc_host),
                   lss_request_message(),
                   lss_answer_message()};
  for (const Joint& joint : joints) {
    add_messages(file, joint);
  }
  write_dbc(out, file);
}

Broadcast broadcast_of(const Declaration& declaration) {
  Broadcast fields;
  for (const FrameField& field : declaration.frame) {
    const InternalValue& value = declaration.internal_values[field.internal_value];
    fields.push_back({signal_name(value.name), value.unit, field.bytes, std::string(value.help)});
  }
  return fields;
}

/// The fields that are equal in the frames of all algorithms that have them, for a robot whose algorithms are not
/// known.
Broadcast common_broadcast() {
  Broadcast common;
  std::size_t agreed = std::numeric_limits<std::size_t>::max();
  for (std::size_t i = 0; i < algorithm_count(); ++i) {
    const Broadcast fields = broadcast_of(algorithm_at(i).declaration());
    const auto [ours, theirs] = std::ranges::mismatch(
        common, fields, [](const BroadcastField& a, const BroadcastField& b) { return a.same_place(b); });
    if (ours != common.end() && theirs != fields.end()) {
      agreed = std::min(agreed, static_cast<std::size_t>(ours - common.begin()));
    }
    if (fields.size() > common.size()) {
      common.insert(common.end(), fields.begin() + static_cast<std::ptrdiff_t>(common.size()), fields.end());
    }
  }
  common.resize(std::min(common.size(), agreed));
  for (BroadcastField& field : common) {
    field.help = "of the algorithms that broadcast it (docs/algorithms.md)";
  }
  return common;
}

/// Sets the joints' names as parts of names in the file. If a name is too long or occurs twice, all end with the node
/// id.
void name_joints(std::vector<Joint>& joints) {
  constexpr std::size_t longest = max_dbc_name - std::string_view("_SecondState").size();
  constexpr std::size_t longest_suffix = std::string_view("_126").size();
  std::set<std::string> names{lower_case(dbc_host)};
  bool good = true;
  for (Joint& joint : joints) {
    joint.name = dbc_name(joint.name);
    good = names.insert(lower_case(joint.name)).second && joint.name.size() <= longest && good;
  }
  for (Joint& joint : joints) {
    if (!good) {
      joint.name = joint.name.substr(0, longest - longest_suffix) + "_" + std::to_string(joint.node);
    }
  }
}

}  // namespace

void print_dbc(std::ostream& out, const sim::Scenario& scenario) {
  std::vector<Joint> joints;
  for (unsigned number = 0; number < scenario.kernel.joint_count; ++number) {
    Joint joint{scenario.modules[number].node, scenario.robot.joints[number].name, {}, number == 0, {Broadcast{}, {}}};
    joint.comment = "joint " + joint.name + ", node " + std::to_string(joint.node);
    for (unsigned slot = 0; slot < max_slots; ++slot) {
      const Slot& used = scenario.kernel.slots[slot];
      if (used.broadcasts() && used.group.contains(number)) {
        const unsigned channel = scenario.kernel.second_channel(slot).contains(number) ? 1 : 0;
        joint.broadcasts[channel] = broadcast_of(used.algorithm->declaration());
      }
    }
    joints.push_back(std::move(joint));
  }
  name_joints(joints);
  print_dbc(out, joints);
}

void print_dbc(std::ostream& out, unsigned nodes) {
  std::vector<Joint> joints;
  for (unsigned node = 1; node <= nodes; ++node) {
    const std::string number = std::to_string(node);
    joints.push_back({static_cast<std::uint8_t>(node),
                      "Node" + number,
                      "node " + number,
                      true,
                      {common_broadcast(), common_broadcast()}});
  }
  print_dbc(out, joints);
}

}  // namespace proleg::tools
