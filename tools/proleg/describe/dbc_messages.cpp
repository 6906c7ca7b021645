#include "tools/proleg/describe/dbc_messages.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "shared/canopen/lss_frame.hpp"
#include "shared/canopen/objects.hpp"
#include "shared/canopen/power_state.hpp"
#include "shared/canopen/sdo_frame.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::tools {

using namespace proleg::canopen;

double factor_of(UnitScale scale, unsigned dropped_bits) {
  return std::ldexp(static_cast<double>(scale.denominator) / static_cast<double>(scale.numerator),
                    static_cast<int>(dropped_bits));
}

std::string unit_of(UnitScale scale) {
  return scale.symbol == std::string_view(scale_of(Unit::ratio).symbol) ? "" : scale.symbol;
}

DbcSignal plain(std::string name, unsigned start, unsigned bits, std::string comment) {
  DbcSignal signal{.name = std::move(name), .start = start, .bits = bits, .comment = std::move(comment)};
  set_full_range(signal);
  return signal;
}

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

DbcSignal chosen(DbcSignal signal, std::vector<DbcChoice> choices) {
  signal.choices = std::move(choices);
  return signal;
}

void set_receiver(DbcMessage& message, const std::string& node) {
  for (DbcSignal& signal : message.signals) {
    signal.receiver = node;
  }
}

std::string signal_name(std::string_view text) { return dbc_name(lower_case(text)); }

// Values with names.

namespace {

std::vector<DbcChoice> nmt_states() {
  return {choice(NmtState::boot_up, "Boot-up"), choice(NmtState::stopped, "Stopped"),
          choice(NmtState::operational, "Operational"), choice(NmtState::pre_operational, "Pre-operational")};
}

/// Adds the codes of a range that have a description.
template <typename Code>
void add_described(std::vector<DbcChoice>& choices, std::uint32_t first, std::uint32_t last, std::string_view unknown) {
  for (std::uint32_t code = first; code <= last; ++code) {
    const std::string_view text = describe(static_cast<Code>(code));
    if (text != unknown) {
      choices.push_back({code, std::string(text)});
    }
  }
}

std::vector<DbcChoice> abort_codes() {
  std::vector<DbcChoice> choices;
  // Classes 5, 6 and 8 (CiA 301, table 22) are codes of two bytes of which the higher is 0.
  for (std::uint32_t upper = 0x0500; upper <= 0x0800; ++upper) {
    add_described<AbortCode>(choices, upper << 16U, upper << 16U | 0xFFU, describe(static_cast<AbortCode>(~0U)));
  }
  return choices;
}

constexpr std::uint16_t fault_reset = 0x80;

}  // namespace

std::vector<DbcChoice> emergency_codes() {
  std::vector<DbcChoice> choices;
  // This is a vendor's code that the protocol does not use.
  add_described<EmergencyCode>(choices, 0, 0xFFFF, describe(static_cast<EmergencyCode>(0xFFFF)));
  return choices;
}

std::vector<DbcChoice> controlwords() {
  return {{0x00, "Disable voltage"}, {0x02, "Quick stop"},       {0x06, "Shut down"},
          {0x07, "Switch on"},       {0x0F, "Enable operation"}, {fault_reset, "Fault reset"}};
}

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

// Messages that all nodes send or receive.

DbcMessage nmt_message() {
  return {identifier::nmt,
          "Nmt",
          length_of<NmtRequest>(),
          dbc_host,
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
          dbc_host,
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

namespace {

// Services. Their frames have other contents for each value of the first bits. Each value has at least one signal,
// because readers refuse a frame with a value without a signal.

/// A signal that is in the frame with a value of the selecting signal.
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
  /// Adds a service without arguments.
  void add(lss::Service service, const std::string& text) {
    add(service, text, {plain(signal_name(text) + "_unused", 8, 56)});
  }
  /// Adds the services from `first` on, each with a number.
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

}  // namespace

DbcMessage lss_request_message() {
  constexpr std::array<const char*, 4> selection{"Select vendor", "Select product", "Select revision", "Select serial"};
  constexpr std::array<const char*, 6> identification{"Identify vendor",       "Identify product",
                                                      "Identify revision low", "Identify revision high",
                                                      "Identify serial low",   "Identify serial high"};
  DbcMessage message{identifier::lss_request, "LssRequest", 8, dbc_host, "Layer setting services (CiA 305)"};
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
  set_receiver(message, dbc_host);
  return message;
}

DbcMessage sdo_request_message(std::uint8_t node, const std::string& name) {
  DbcMessage message{static_cast<std::uint16_t>(identifier::sdo_request + node), name + "_SdoRequest", 8, dbc_host,
                     "Reads or writes an object"};
  add_sdo_signals(message, sdo_requests);
  set_receiver(message, name);
  return message;
}

DbcMessage sdo_answer_message(std::uint8_t node, const std::string& name) {
  DbcMessage message{static_cast<std::uint16_t>(identifier::sdo_answer + node), name + "_SdoAnswer", 8, name,
                     "The answer to SdoRequest"};
  add_sdo_signals(message, sdo_answers);
  set_receiver(message, dbc_host);
  return message;
}

}  // namespace proleg::tools
