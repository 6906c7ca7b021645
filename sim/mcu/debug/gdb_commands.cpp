#include "sim/mcu/debug/gdb_commands.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "sim/mcu/debug/gdb_packet.hpp"

namespace proleg::sim {
namespace {

// Error numbers of errno; clients show them and do not interpret them.
constexpr const char* malformed = "E16";  // EINVAL
constexpr const char* no_memory = "E0e";  // EFAULT
constexpr const char* done = "OK";
constexpr const char* unknown = "";

constexpr std::size_t max_memory_reply = GdbDecoder::max_packet / 2;

struct Halves {
  std::string_view before;
  std::optional<std::string_view> after;
};

Halves split(std::string_view text, char separator) {
  const std::size_t at = text.find(separator);
  if (at == std::string_view::npos) {
    return {text, std::nullopt};
  }
  return {text.substr(0, at), text.substr(at + 1)};
}

struct Range {
  std::uint32_t start = 0;
  std::uint32_t length = 0;
};

// Parses "START,LENGTH".
std::optional<Range> range_of(std::string_view text) {
  const auto [before, after] = split(text, ',');
  const auto start = hex_number(before);
  const auto length = after ? hex_number(*after) : std::nullopt;
  if (!start || !length) {
    return std::nullopt;
  }
  return Range{*start, *length};
}

// Registers travel in the byte order of the target.
std::string register_text(std::uint32_t value) {
  const std::array<std::uint8_t, 4> bytes{static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value >> 8U),
                                          static_cast<std::uint8_t>(value >> 16U),
                                          static_cast<std::uint8_t>(value >> 24U)};
  return to_hex(bytes);
}

std::optional<std::uint32_t> register_value(std::string_view digits) {
  const auto bytes = from_hex(digits);
  if (!bytes || bytes->size() != 4) {
    return std::nullopt;
  }
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) {
    value = value << 8U | (*bytes)[i];
  }
  return value;
}

// Describes the feature org.gnu.gdb.arm.m-profile ("Debugging with GDB", appendix G.5.3).
std::string target_description() {
  std::string text =
      "<?xml version=\"1.0\"?>\n<!DOCTYPE target SYSTEM \"gdb-target.dtd\">\n<target version=\"1.0\">\n"
      "<architecture>arm</architecture>\n<feature name=\"org.gnu.gdb.arm.m-profile\">\n";
  for (unsigned number = 0; number <= 12; ++number) {
    text.append("<reg name=\"r").append(std::to_string(number)).append("\" bitsize=\"32\" type=\"uint32\"/>\n");
  }
  text +=
      "<reg name=\"sp\" bitsize=\"32\" type=\"data_ptr\"/>\n<reg name=\"lr\" bitsize=\"32\"/>\n"
      "<reg name=\"pc\" bitsize=\"32\" type=\"code_ptr\"/>\n<reg name=\"xpsr\" bitsize=\"32\"/>\n"
      "</feature>\n</target>\n";
  return text;
}

unsigned signal_of(StopReason reason) {
  constexpr unsigned interrupted = 2;
  constexpr unsigned trapped = 5;
  constexpr unsigned bad_access = 11;
  switch (reason) {
    case StopReason::interrupt:
      return interrupted;
    case StopReason::fault:
      return bad_access;
    case StopReason::attached:
    case StopReason::breakpoint:
    case StopReason::step:
      break;
  }
  return trapped;
}

bool means_our_thread(std::string_view thread) { return thread == "1" || thread == "0" || thread == "-1"; }

}  // namespace

GdbCommands::Answer GdbCommands::answer(std::string_view packet) {
  if (packet.empty()) {
    return {unknown, {}};
  }
  const std::string_view rest = packet.substr(1);
  switch (packet.front()) {
    case '?':
      return {stop_reply(), {}};
    case 'g':
      return {read_registers(), {}};
    case 'G':
      return {write_registers(rest), {}};
    case 'p':
      return {read_register(rest), {}};
    case 'P':
      return {write_register(rest), {}};
    case 'm':
      return {read_memory(rest), {}};
    case 'M':
      return {write_memory(rest, false), {}};
    case 'X':
      return {write_memory(rest, true), {}};
    case 'Z':
      return {change_breakpoint(rest, true), {}};
    case 'z':
      return {change_breakpoint(rest, false), {}};
    case 'c':
      return resume(Resume::run, rest);
    case 's':
      return resume(Resume::step, rest);
    // Resume with a signal, which a bare CPU does not have.
    case 'C':
      return resume(Resume::run, split(rest, ';').after.value_or(""));
    case 'S':
      return resume(Resume::step, split(rest, ';').after.value_or(""));
    case 'D':
      clear_breakpoints();
      return {done, Resume::detach};
    case 'k':
      clear_breakpoints();
      return {std::nullopt, Resume::kill};
    case 'H':
      return {done, {}};
    case 'T':
      return {means_our_thread(rest) ? done : malformed, {}};
    case 'q':
      return {query(rest), {}};
    case 'v':
      // GDB uses vCont only if all four are supported.
      if (rest == "Cont?") {
        return {"vCont;c;C;s;S", {}};
      }
      if (rest.starts_with("Cont;")) {
        return resume_threads(rest.substr(5));
      }
      return {unknown, {}};
    default:
      return {unknown, {}};
  }
}

std::string GdbCommands::stop_reply() const {
  constexpr std::array<unsigned, 4> shown{7, 13, 14, DebugTarget::program_counter};
  const auto signal = static_cast<std::uint8_t>(signal_of(reason_));
  std::string reply = "T" + to_hex({&signal, 1});
  for (const unsigned shown_number : shown) {
    const auto number = static_cast<std::uint8_t>(shown_number);
    reply.append(to_hex({&number, 1})).append(":").append(register_text(target_->core_register(number))).append(";");
  }
  return reply + "thread:1;";
}

void GdbCommands::clear_breakpoints() {
  breakpoints_.clear();
  apply_breakpoints();
}

GdbCommands::Answer GdbCommands::resume(Resume how, std::string_view address) {
  if (!address.empty()) {
    const auto target = hex_number(address);
    if (!target) {
      return {malformed, {}};
    }
    target_->set_core_register(DebugTarget::program_counter, *target);
  }
  apply_breakpoints();
  return {std::nullopt, how};
}

// Parses "ACTION[:THREAD];ACTION[:THREAD]...": the first action that names the thread counts.
GdbCommands::Answer GdbCommands::resume_threads(std::string_view actions) {
  for (std::optional<std::string_view> rest = actions; rest;) {
    const auto [item, others] = split(*rest, ';');
    const auto [action, thread] = split(item, ':');
    rest = others;
    if (thread && !means_our_thread(*thread)) {
      continue;
    }
    if (action == "c" || (action.starts_with('C') && hex_number(action.substr(1)))) {
      return resume(Resume::run, {});
    }
    if (action == "s" || (action.starts_with('S') && hex_number(action.substr(1)))) {
      return resume(Resume::step, {});
    }
    return {malformed, {}};
  }
  return {malformed, {}};
}

std::string GdbCommands::query(std::string_view packet) const {
  const auto [head, tail] = split(packet, ':');
  if (head == "Supported") {
    const std::uint16_t size = GdbDecoder::max_packet;
    const std::array<std::uint8_t, 2> bytes{static_cast<std::uint8_t>(size >> 8U), static_cast<std::uint8_t>(size)};
    return "PacketSize=" + to_hex(bytes) + ";QStartNoAckMode+;qXfer:features:read+;vContSupported+";
  }
  constexpr std::string_view description_read = "Xfer:features:read:";
  if (packet.starts_with(description_read)) {
    return features(packet.substr(description_read.size()));
  }
  constexpr std::string_view monitor_command = "Rcmd,";
  if (packet.starts_with(monitor_command)) {
    return monitor(packet.substr(monitor_command.size()));
  }
  if (packet == "C") {
    return "QC1";
  }
  if (packet == "fThreadInfo") {
    return "m1";
  }
  if (packet == "sThreadInfo") {
    return "l";
  }
  if (head == "Attached") {
    return "1";  // A client that quits then detaches and does not kill.
  }
  return unknown;
}

std::string GdbCommands::features(std::string_view range) const {
  const auto [name, rest] = split(range, ':');
  if (name != "target.xml") {
    return "E00";
  }
  const auto part = range_of(rest.value_or(""));
  const std::string text = target_description();
  if (!part || part->start > text.size()) {
    return malformed;
  }
  const std::size_t length = std::min<std::size_t>(part->length, max_memory_reply);
  const bool last = part->start + length >= text.size();
  return (last ? "l" : "m") + text.substr(part->start, length);
}

std::string GdbCommands::monitor(std::string_view digits) const {
  if (!monitor_) {
    return unknown;
  }
  const auto bytes = from_hex(digits);
  if (!bytes) {
    return malformed;
  }
  std::string text = monitor_(std::string(bytes->begin(), bytes->end()));
  text.resize(std::min(text.size(), max_memory_reply));
  return text.empty() ? done : to_hex(std::vector<std::uint8_t>(text.begin(), text.end()));
}

std::string GdbCommands::read_registers() const {
  std::string text;
  for (unsigned number = 0; number < DebugTarget::register_count; ++number) {
    text += register_text(target_->core_register(number));
  }
  return text;
}

std::string GdbCommands::write_registers(std::string_view digits) {
  constexpr std::size_t width = 8;
  if (digits.size() != width * DebugTarget::register_count || !from_hex(digits)) {
    return malformed;
  }
  for (unsigned number = 0; number < DebugTarget::register_count; ++number) {
    target_->set_core_register(number, *register_value(digits.substr(width * number, width)));
  }
  return done;
}

std::string GdbCommands::read_register(std::string_view number) const {
  const auto index = hex_number(number);
  if (!index || *index >= DebugTarget::register_count) {
    return malformed;
  }
  return register_text(target_->core_register(*index));
}

std::string GdbCommands::write_register(std::string_view assignment) {
  const auto [number, digits] = split(assignment, '=');
  const auto index = hex_number(number);
  const auto value = digits ? register_value(*digits) : std::nullopt;
  if (!index || *index >= DebugTarget::register_count || !value) {
    return malformed;
  }
  target_->set_core_register(*index, *value);
  return done;
}

std::string GdbCommands::read_memory(std::string_view range) const {
  const auto wanted = range_of(range);
  if (!wanted) {
    return malformed;
  }
  const std::uint64_t to_end = (std::uint64_t{1} << 32U) - wanted->start;
  std::vector<std::uint8_t> bytes(std::min<std::uint64_t>({wanted->length, max_memory_reply, to_end}));
  if (target_->read_memory(wanted->start, bytes)) {
    return to_hex(bytes);
  }
  // A client accepts fewer bytes than it asked for: up to the end of the memory.
  std::size_t there = 0;
  while (there < bytes.size() &&
         target_->read_memory(wanted->start + static_cast<std::uint32_t>(there), std::span(bytes).subspan(there, 1))) {
    ++there;
  }
  return there == 0 ? no_memory : to_hex(std::span(bytes).first(there));
}

std::string GdbCommands::write_memory(std::string_view text, bool binary) {
  const auto [range, content] = split(text, ':');
  const auto wanted = range_of(range);
  if (!wanted || !content) {
    return malformed;
  }
  const auto bytes =
      binary ? std::optional(std::vector<std::uint8_t>(content->begin(), content->end())) : from_hex(*content);
  if (!bytes || bytes->size() != wanted->length) {
    return malformed;
  }
  if (std::uint64_t{wanted->start} + wanted->length > std::uint64_t{1} << 32U) {
    return no_memory;
  }
  // A client sends no bytes to ask whether the server supports the command.
  return bytes->empty() || target_->write_memory(wanted->start, *bytes) ? done : no_memory;
}

// Parses "KIND,ADDRESS,SIZE[;CONDITIONS]".
std::string GdbCommands::change_breakpoint(std::string_view text, bool insert) {
  const auto [kind, rest] = split(text, ',');
  if (kind.size() != 1 || !rest) {
    return malformed;
  }
  if (kind != "0" && kind != "1") {
    return unknown;  // Kinds 2 to 4 are watchpoints.
  }
  const auto range = range_of(split(*rest, ';').before);
  if (!range) {
    return malformed;
  }
  const std::pair breakpoint(range->start & ~1U, kind.front());
  if (insert) {
    breakpoints_.insert(breakpoint);
  } else {
    breakpoints_.erase(breakpoint);
  }
  return done;
}

// Clients remove all breakpoints at each stop and set them again before they resume; the target does not need these
// changes.
void GdbCommands::apply_breakpoints() {
  std::vector<std::uint32_t> addresses;
  for (const auto& [address, kind] : breakpoints_) {
    if (addresses.empty() || addresses.back() != address) {
      addresses.push_back(address);
    }
  }
  if (addresses != applied_) {
    target_->set_breakpoints(addresses);
    applied_ = std::move(addresses);
  }
}

}  // namespace proleg::sim
