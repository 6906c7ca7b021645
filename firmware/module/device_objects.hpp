#pragma once

// The object dictionary of the module: the table that says how SDO reads and writes the module, and the server that
// uses it.

#include <array>
#include <span>
#include <string_view>

#include "firmware/module/parts.hpp"
#include "shared/canopen/sdo_server.hpp"

namespace proleg::firmware {

/// Position of an entry in its series: steps of index and sub-index from the first one; both 0 for a single entry. In a
/// range of values: the number of the parameter or internal value, and the slot.
struct Position {
  std::uint16_t index = 0;
  std::uint16_t sub = 0;
};

/// The states in which SDO may write an entry. In others the module rejects the write with `refused_by_state`.
enum class WritableIn : std::uint8_t {
  no_state,
  any_state,
  configured,  ///< after `activate`
  pre_operational,
  configured_and_pre_operational,
  open_transaction,
};

/// A write of a value that has passed the declared range.
struct ObjectWrite {
  Position position;
  std::uint32_t value = 0;  ///< signed types are sign-extended
  Microseconds now = 0;
};

/// A row of the table. It stands for a declared entry of the object dictionary (shared/canopen), or for a series of
/// similar entries. An entry whose declaration gives its value (canopen::fixed_value) has no row. The functions of a
/// range are called only if the joint's slot has the algorithm.
struct ObjectAccessor {
  using Get = std::uint32_t (*)(const Parts& parts, Position position);
  using Set = canopen::AbortCode (*)(Parts& parts, const ObjectWrite& write);

  std::uint16_t index = 0;  ///< index of the first entry of the series
  std::uint8_t sub = 0;
  WritableIn writable_in = WritableIn::no_state;
  Get get = nullptr;
  Set set = nullptr;  ///< null: SDO does not write the entry

  [[nodiscard]] constexpr canopen::Address first() const { return {index, sub}; }
};

/// Address of the first entry of a range of values (shared/canopen/objects.hpp).
[[nodiscard]] constexpr canopen::Address first_of(canopen::ValueKind range) {
  return canopen::address_of({range, 0, 0, 0});
}

/// The table of all rows.
[[nodiscard]] std::span<const ObjectAccessor> object_accessors();

/// SDO abort code that stands for a status of the kernel.
[[nodiscard]] canopen::AbortCode abort_code_of(Status status);

/// Reads a declared entry. `unsupported_access` if the table has no row for it.
[[nodiscard]] canopen::AbortCode read_object(std::span<const ObjectAccessor> accessors, const Parts& parts,
                                             canopen::Address address, std::uint32_t& value);
/// Writes a declared entry with a value that has passed the declared range. `unsupported_access` if the table has no
/// row for the entry.
[[nodiscard]] canopen::AbortCode write_object(std::span<const ObjectAccessor> accessors, Parts& parts,
                                              canopen::Address address, std::uint32_t value, Microseconds now);

/// The value of an entry of type VISIBLE_STRING.
class ObjectText {
 public:
  [[nodiscard]] std::span<const char> characters() const { return {characters_.data(), size_}; }
  constexpr void append(char character) {
    if (size_ < characters_.size()) {
      characters_[size_++] = character;
    }
  }
  constexpr void append(std::string_view text) {
    for (const char character : text) {
      append(character);
    }
  }
  constexpr void append_hex(std::uint32_t value) {
    for (unsigned shift = 32; shift > 0;) {
      shift -= 4;
      append("0123456789ABCDEF"[value >> shift & 0xFU]);
    }
  }
  constexpr void append_decimal(unsigned value) {
    unsigned power = 1;
    while (value / power >= 10) {
      power *= 10;
    }
    for (; power > 0; power /= 10) {
      append(static_cast<char>('0' + value / power % 10));
    }
  }

 private:
  std::array<char, 32> characters_{};
  std::uint8_t size_ = 0;
};
/// Text of an entry; nothing if the module has no such text.
[[nodiscard, gnu::cold]] std::optional<ObjectText> read_text(const ModuleIdentity& identity, canopen::Address address);

/// The SDO server of the module's object dictionary. It serves the entries of object_accessors() with their present
/// values.
///
/// The host writes the configuration of the robot in Pre-operational; it takes effect at `activate`. After that it
/// writes parameters and limits. In an open transaction it stages parameters and internal values in any state.
class DeviceObjects final : private canopen::ObjectAccess {
 public:
  explicit DeviceObjects(Parts& parts) : parts_(parts), server_(parts.identity.node, *this) {}

  /// Answers a frame on 0x600 + node.
  [[gnu::cold]] void serve(Microseconds now, const CanFrame& request);
  /// Sends segments of a block upload while the queue is empty. Must be called when a frame was sent.
  void send_segments(Microseconds now);
  [[gnu::cold]] void poll(Microseconds now);
  [[nodiscard]] Microseconds next_deadline() const { return server_.next_deadline(); }
  /// Drops the transfer. The server takes the module's present node id.
  void reset() {
    server_.reset();
    server_.set_node(parts_.identity.node);
  }

 private:
  canopen::AbortCode read(const canopen::Entry& entry, std::uint32_t& value) override;
  canopen::AbortCode write(const canopen::Entry& entry, std::uint32_t value) override;
  canopen::AbortCode open_read(const canopen::Entry& entry, std::uint32_t& size) override;
  canopen::AbortCode read_part(const canopen::Entry& entry, std::uint32_t offset,
                               std::span<std::uint8_t> part) override;

  Parts& parts_;
  canopen::SdoServer server_;
  Microseconds now_ = 0;  ///< time of the request that is served
};

}  // namespace proleg::firmware
