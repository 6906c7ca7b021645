#include "tools/proleg/describe/dbc.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "shared/canopen/lss_frame.hpp"
#include "shared/canopen/objects.hpp"
#include "shared/canopen/power_state.hpp"
#include "shared/canopen/sdo_frame.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/registry.hpp"
#include "tools/proleg/describe/dbc_file.hpp"

namespace proleg::tools {
namespace {

using namespace proleg::canopen;

constexpr const char* host = "Host";

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
  std::string name;           ///< of its messages
  std::string comment;        ///< on its node
  bool has_far_link = false;  ///< its frame has the contacts of the link in front, too
  /// By channel; nothing: the frame is not sent.
  std::array<std::optional<Broadcast>, max_channels> broadcasts;
};

// Signals.

double factor_of(UnitScale scale, unsigned dropped_bits = 0) {
  return std::ldexp(static_cast<double>(scale.denominator) / static_cast<double>(scale.numerator),
                    static_cast<int>(dropped_bits));
}

std::string unit_of(UnitScale scale) {
  return scale.symbol == std::string_view(scale_of(Unit::ratio).symbol) ? "" : scale.symbol;
}

/// Whole numbers.
DbcSignal plain(std::string name, unsigned start, unsigned bits, std::string comment = {}) {
  DbcSignal signal{.name = std::move(name), .start = start, .bits = bits, .comment = std::move(comment)};
  set_full_range(signal);
  return signal;
}

/// The bits in which frames differ, as a signal: they are where an encoder writes a field that has other values in
/// them.
DbcSignal difference(std::string name, const CanFrame& frame, std::span<const CanFrame> others) {
  std::uint64_t bits = 0;
  for (const CanFrame& other : others) {
    for (unsigned byte = 0; byte < 8; ++byte) {
      bits |= std::uint64_t{static_cast<std::uint8_t>(frame.data[byte] ^ other.data[byte])} << 8U * byte;
    }
  }
  const auto start = static_cast<unsigned>(std::countr_zero(bits));
  const auto count = static_cast<unsigned>(std::popcount(bits));
  if (bits == 0 || start + count != static_cast<unsigned>(std::bit_width(bits))) {
    throw std::logic_error("the bits of " + name + " are not one field");
  }
  return plain(std::move(name), start, count);
}

/// A member of a message of messages.hpp.
template <typename Message, typename Member>
DbcSignal member(std::string name, Member Message::*pointer, std::string comment = {}) {
  std::array<std::uint8_t, sizeof(Member)> ones{};
  ones.fill(0xFF);
  Message other{};
  other.*pointer = std::bit_cast<Member>(ones);
  const std::array others{encode(other)};
  DbcSignal signal = difference(std::move(name), encode(Message{}), others);
  signal.is_signed = std::is_signed_v<Member>;
  signal.comment = std::move(comment);
  set_full_range(signal);
  return signal;
}

template <typename Message>
unsigned length_of() {
  return encode(Message{}).length;
}

DbcSignal chosen(DbcSignal signal, std::vector<DbcChoice> choices) {
  signal.choices = std::move(choices);
  return signal;
}

void set_receiver(DbcMessage& message, const std::string& node) {
  for (DbcSignal& signal : message.signals) {
    signal.receiver = node;
  }
}

/// "Target position": target_position
std::string signal_name(std::string_view text) { return dbc_name(lower_case(text)); }

// Values with names.

template <typename Code>
DbcChoice choice(Code code, std::string text) {
  return {static_cast<std::int64_t>(code), std::move(text)};
}

std::vector<DbcChoice> nmt_states() {
  return {choice(NmtState::boot_up, "Boot-up"), choice(NmtState::stopped, "Stopped"),
          choice(NmtState::operational, "Operational"), choice(NmtState::pre_operational, "Pre-operational")};
}

/// Those of a range of codes that have a description.
template <typename Code>
void add_described(std::vector<DbcChoice>& choices, std::uint32_t first, std::uint32_t last, std::string_view unknown) {
  for (std::uint32_t code = first; code <= last; ++code) {
    const std::string_view text = describe(static_cast<Code>(code));
    if (text != unknown) {
      choices.push_back({code, std::string(text)});
    }
  }
}

std::vector<DbcChoice> emergency_codes() {
  std::vector<DbcChoice> choices;
  // A vendor's code that the protocol does not use.
  add_described<EmergencyCode>(choices, 0, 0xFFFF, describe(static_cast<EmergencyCode>(0xFFFF)));
  return choices;
}

std::vector<DbcChoice> abort_codes() {
  std::vector<DbcChoice> choices;
  // CiA 301, table 22: classes 5, 6 and 8, codes of two bytes of which the higher is 0.
  for (std::uint32_t upper = 0x0500; upper <= 0x0800; ++upper) {
    add_described<AbortCode>(choices, upper << 16U, upper << 16U | 0xFFU, describe(static_cast<AbortCode>(~0U)));
  }
  return choices;
}

constexpr std::uint16_t fault_reset = 0x80;

/// CiA 402, command coding, as a host writes them.
std::vector<DbcChoice> controlwords() {
  return {{0x00, "Disable voltage"}, {0x02, "Quick stop"},       {0x06, "Shut down"},
          {0x07, "Switch on"},       {0x0F, "Enable operation"}, {fault_reset, "Fault reset"}};
}

/// By a walk through the states.
std::vector<DbcChoice> statuswords() {
  PowerControl power;
  std::vector<DbcChoice> choices{choice(power.statusword(), "Switch on disabled")};
  power.command(0x06);
  choices.push_back(choice(power.statusword(), "Ready to switch on"));
  power.command(0x07);
  choices.push_back(choice(power.statusword(), "Switched on"));
  power.command(0x0F);
  choices.push_back(choice(power.statusword(), "Operation enabled"));
  power.quick_stop();
  choices.push_back(choice(power.statusword(), "Quick stop active"));
  power.fault();
  choices.push_back(choice(power.statusword(), "Fault"));
  return choices;
}

// Messages to and from all.

DbcMessage nmt_message() {
  return {identifier::nmt,
          "Nmt",
          length_of<NmtRequest>(),
          host,
          "Network management",
          {chosen(member("command", &NmtRequest::command),
                  {choice(NmtCommand::start, "Start"), choice(NmtCommand::stop, "Stop"),
                   choice(NmtCommand::enter_pre_operational, "Enter Pre-operational"),
                   choice(NmtCommand::reset_node, "Reset node"),
                   choice(NmtCommand::reset_communication, "Reset communication")}),
           chosen(member("node", &NmtRequest::node), {{0, "all"}})}};
}

DbcMessage sync_message(const std::string& producer) {
  std::vector<CanFrame> others;
  for (std::uint32_t tick = 1; tick < sync_counters; ++tick) {
    others.push_back(encode_sync(tick));
  }
  DbcSignal counter = difference("counter", encode_sync(0), others);
  counter.minimum = sync_counter(0);
  counter.maximum = sync_counters;
  counter.comment = "tick mod 128 + 1";
  return {identifier::sync, "Sync", encode_sync(0).length, producer, "Begins a tick", {counter}};
}

DbcMessage tick_message(const std::string& producer) {
  return {identifier::tick,
          "Tick",
          length_of<TickMessage>(),
          producer,
          "Announces the SYNC that follows",
          {member("tick", &TickMessage::tick, "of the SYNC that follows"),
           member("configuration_crc", &TickMessage::configuration_crc, "as in object 0x2001:6")}};
}

DbcMessage commit_message() {
  return {identifier::commit,
          "Commit",
          length_of<CommitMessage>(),
          host,
          "Staged values of a transaction take effect at a tick",
          {member("transaction", &CommitMessage::transaction), member("tick", &CommitMessage::tick),
           member("robot", &CommitMessage::robot)}};
}

DbcMessage heartbeat_message(std::uint8_t node, const std::string& name) {
  return {encode(Heartbeat{node, NmtState::operational}).identifier,
          name + "_Heartbeat",
          length_of<Heartbeat>(),
          name,
          "Boot-up and heartbeat",
          {chosen(member("state", &Heartbeat::state), nmt_states())}};
}

// Services, whose frames have other contents for each value of their first bits. Each value has a signal at least,
// because readers refuse a frame with a value that has none.

/// A signal that is in the frame with that value of the selecting one.
DbcSignal selected(unsigned value, DbcSignal signal) {
  signal.multiplex = "m" + std::to_string(value);
  return signal;
}

/// The frames that begin with a command specifier, of requests or of answers.
struct SdoFrame {
  std::uint8_t specifier;
  const char* name;
  bool has_address;  ///< index, sub-index and four bytes; else seven bytes
  const char* text;
};

constexpr std::array sdo_requests{
    SdoFrame{sdo::request_download_segment, "download_segment", false, "Download segment"},
    SdoFrame{sdo::request_download, "download", true, "Initiate download"},
    SdoFrame{sdo::request_upload, "upload", true, "Initiate upload"},
    SdoFrame{sdo::request_upload_segment, "upload_segment", false, "Upload segment"},
    SdoFrame{sdo::abort, "abort", true, "Abort"},
    SdoFrame{sdo::answer_block_download, "block_upload", false, "Block upload"},
    SdoFrame{sdo::block_download, "block_download", false, "Block download"},
    SdoFrame{0xE0, "segment", false, "Segment of a block"},
};
constexpr std::array sdo_answers{
    SdoFrame{sdo::answer_upload_segment, "upload_segment", false, "Upload segment"},
    SdoFrame{sdo::answer_download_segment, "download_segment", false, "Download segment"},
    SdoFrame{sdo::answer_upload, "upload", true, "Initiate upload"},
    SdoFrame{sdo::answer_download, "download", true, "Initiate download"},
    SdoFrame{sdo::abort, "abort", true, "Abort"},
    SdoFrame{sdo::answer_block_download, "block_download", false, "Block download"},
    SdoFrame{sdo::block_download, "block_upload", false, "Block upload"},
    SdoFrame{0xE0, "segment", false, "Segment of a block"},
};

void add_sdo_signals(DbcMessage& message, std::span<const SdoFrame> frames) {
  constexpr unsigned specifier_start = 5;
  const auto part = [](const std::string& name, const CanFrame& ones) {
    return difference(name, sdo::make(0, 0, {}), std::array{ones});
  };
  DbcSignal specifier = plain("specifier", specifier_start, 8 - specifier_start,
                              "segments of a block begin with their number instead, and are not decoded");
  specifier.multiplex = "M";
  for (const SdoFrame& frame : frames) {
    specifier.choices.push_back({frame.specifier >> specifier_start, frame.text});
  }
  message.signals.push_back(specifier);
  for (const SdoFrame& frame : frames) {
    const std::string prefix = std::string(frame.name) + '_';
    const auto add = [&](DbcSignal signal) {
      message.signals.push_back(selected(frame.specifier >> specifier_start, std::move(signal)));
    };
    add(plain(prefix + "flags", 0, specifier_start));
    if (frame.has_address) {
      add(part(prefix + "index", sdo::make(0, 0, {0xFFFF, 0})));
      add(part(prefix + "sub", sdo::make(0, 0, {0, 0xFF})));
      DbcSignal data = part(prefix + "data", sdo::make(0, 0, {}, 4, 0xFFFFFFFF));
      if (frame.specifier == sdo::abort) {
        data.name = prefix + "code";
        data.choices = abort_codes();
      }
      add(data);
    } else {
      add(plain(prefix + "data", 8, 56));
    }
  }
}

class LssSignals {
 public:
  explicit LssSignals(DbcMessage& message) : message_(message) {
    message.signals.push_back(plain("service", 0, 8));
    message.signals.back().multiplex = "M";
  }
  LssSignals(const LssSignals&) = delete;

  void add(lss::Service service, const std::string& text, std::vector<DbcSignal> contents) {
    add(static_cast<std::uint8_t>(service), text, std::move(contents));
  }
  /// A service that is only its name.
  void add(lss::Service service, const std::string& text) {
    add(service, text, {plain(signal_name(text) + "_unused", 8, 56)});
  }
  /// The services `first` and those after it: a number each.
  void add_words(lss::Service first, std::span<const char* const> names) {
    auto service = static_cast<std::uint8_t>(first);
    for (const char* const name : names) {
      add(service++, name,
          {difference(signal_name(name), lss::make(0, first), std::array{lss::make_word(0, first, 0xFFFFFFFF)})});
    }
  }

 private:
  void add(std::uint8_t service, const std::string& text, std::vector<DbcSignal> contents) {
    message_.signals.front().choices.push_back({service, text});
    for (DbcSignal& signal : contents) {
      message_.signals.push_back(selected(service, std::move(signal)));
    }
  }

  DbcMessage& message_;
};

constexpr std::array<const char*, 4> inquired{"Inquire vendor", "Inquire product", "Inquire revision",
                                              "Inquire serial"};
constexpr unsigned first_byte = 8;
constexpr unsigned second_byte = 16;

DbcMessage lss_request_message() {
  constexpr std::array<const char*, 4> selection{"Select vendor", "Select product", "Select revision", "Select serial"};
  constexpr std::array<const char*, 6> identification{"Identify vendor",       "Identify product",
                                                      "Identify revision low", "Identify revision high",
                                                      "Identify serial low",   "Identify serial high"};
  DbcMessage message{identifier::lss_request, "LssRequest", 8, host, "Layer setting services (CiA 305)"};
  LssSignals signals(message);
  signals.add(lss::Service::switch_state_global, "Switch state global",
              {chosen(plain("state", first_byte, 8),
                      {choice(lss::State::waiting, "Waiting"), choice(lss::State::configuration, "Configuration")})});
  signals.add(lss::Service::configure_node_id, "Configure node id",
              {chosen(plain("node_id", first_byte, 8), {choice(lss::no_node_id, "none")})});
  signals.add(lss::Service::configure_bit_timing, "Configure bit timing",
              {plain("timing_table", first_byte, 8), plain("timing_index", second_byte, 8)});
  DbcSignal delay = plain("switch_delay", first_byte, 16);
  delay.unit = "ms";
  signals.add(lss::Service::activate_bit_timing, "Activate bit timing", {delay});
  signals.add(lss::Service::store_configuration, "Store configuration");
  signals.add_words(lss::Service::select_vendor, selection);
  signals.add_words(lss::Service::identify_vendor, identification);
  signals.add(lss::Service::identify_non_configured, "Identify non-configured");
  signals.add(
      lss::Service::fastscan, "Fastscan",
      {member("fastscan_number", &lss::FastscanRequest::number),
       chosen(member("fastscan_bit", &lss::FastscanRequest::bit), {choice(lss::fastscan_start, "start")}),
       member("fastscan_sub", &lss::FastscanRequest::sub), member("fastscan_next", &lss::FastscanRequest::next)});
  auto service = static_cast<std::uint8_t>(lss::Service::inquire_vendor);
  for (const char* const name : inquired) {
    signals.add(static_cast<lss::Service>(service++), name);
  }
  signals.add(lss::Service::inquire_node_id, "Inquire node id");
  return message;
}

DbcMessage lss_answer_message() {
  DbcMessage message{identifier::lss_answer, "LssAnswer", 8, any_node, "Layer setting services (CiA 305)"};
  LssSignals signals(message);
  const auto add_result = [&](lss::Service service, const std::string& text) {
    signals.add(service, text,
                {chosen(plain(signal_name(text) + "_error", first_byte, 8), {{lss::ok, "accepted"}}),
                 plain(signal_name(text) + "_detail", second_byte, 8)});
  };
  add_result(lss::Service::configure_node_id, "Configure node id");
  add_result(lss::Service::configure_bit_timing, "Configure bit timing");
  add_result(lss::Service::store_configuration, "Store configuration");
  signals.add(lss::Service::selected, "Selected");
  signals.add(lss::Service::identified, "Identified");
  signals.add(lss::Service::identified_non_configured, "Identified non-configured");
  signals.add_words(lss::Service::inquire_vendor, inquired);
  signals.add(lss::Service::inquire_node_id, "Inquire node id",
              {chosen(plain("node_id", first_byte, 8), {choice(lss::no_node_id, "none")})});
  set_receiver(message, host);
  return message;
}

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

/// What the mapping parameters of a PDO say, in their order.
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
  DbcMessage message{static_cast<std::uint16_t>(identifier::command + joint.node), joint.name + "_Command", 0, host,
                     "RPDO1: drive state, and set-point in the mode direct position"};
  add_mapped(message, object::command_mapped);
  set_receiver(message, joint.name);
  return message;
}

DbcMessage monitoring_message(const Joint& joint) {
  DbcMessage message{static_cast<std::uint16_t>(identifier::monitoring + joint.node), joint.name + "_Monitoring", 0,
                     joint.name, "TPDO3: what the module measures, every 10th or 100th tick"};
  add_mapped(message, object::monitoring_mapped);
  set_receiver(message, host);
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
  const bool is_count = field.unit == Unit::count;  // these send their low bits, others the high ones
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
  set_receiver(file.messages.back(), host);
  file.messages.push_back({static_cast<std::uint16_t>(identifier::sdo_request + joint.node), joint.name + "_SdoRequest",
                           8, host, "Reads or writes an object"});
  add_sdo_signals(file.messages.back(), sdo_requests);
  set_receiver(file.messages.back(), joint.name);
  file.messages.push_back({static_cast<std::uint16_t>(identifier::sdo_answer + joint.node), joint.name + "_SdoAnswer",
                           8, joint.name, "The answer to SdoRequest"});
  add_sdo_signals(file.messages.back(), sdo_answers);
  set_receiver(file.messages.back(), host);
}

/// joints: in kernel order; the module of the first one sends SYNC.
void print_dbc(std::ostream& out, const std::vector<Joint>& joints) {
  DbcFile file;
  file.version = "protocol " + std::to_string(protocol_version >> 8U) + "." + std::to_string(protocol_version & 0xFFU);
  file.comment = "Proleg, 1 Mbit/s; written by 'proleg objects --dbc'; docs/protocol.md explains the frames";
  file.nodes.push_back({host, "node " + std::to_string(host_node)});
  for (const Joint& joint : joints) {
    file.nodes.push_back({joint.name, joint.comment});
  }
  file.tables.push_back({"statusword", statuswords()});
  const std::string& producer = joints.front().name;
  file.messages = {nmt_message(),
                   sync_message(producer),
                   tick_message(producer),
                   commit_message(),
                   heartbeat_message(host_node, host),
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

/// What is the same in the frames of all algorithms that have it: of a robot whose algorithms are not known.
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

/// Names of the joints as parts of names in the file. If one is too long or is there twice, all end with the node id.
void name_joints(std::vector<Joint>& joints) {
  constexpr std::size_t longest = max_dbc_name - std::string_view("_SecondState").size();
  constexpr std::size_t longest_suffix = std::string_view("_126").size();
  std::set<std::string> names{lower_case(host)};
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
