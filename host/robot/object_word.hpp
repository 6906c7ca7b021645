#pragma once

// Reads the names that people use for objects of a module, and shows values of objects.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/canopen/objects.hpp"

namespace proleg::host {

/// An argument that names an object:
///   0x6064, 6064, 0x1018:4, 1018:4   index and sub-index, hexadecimal and decimal
///   "Joint index"                    the name of the object dictionary, in any case; with that of its index if several
///                                    entries have the name: "Place in the robot: Joint index"
///   amplitude, amplitude:2           a parameter of the algorithm in slot 1, or another slot, of that module
class ObjectWord {
 public:
  /// Throws InputError for an argument that names no object, or several.
  explicit ObjectWord(std::string_view word);

  /// The slot (0 to 3) whose algorithm decides which object it is; nothing: object() needs no algorithm.
  [[nodiscard]] std::optional<std::uint8_t> slot() const { return slot_; }
  /// The object. algorithm: id of the algorithm in the slot, 0: none. Throws InputError if the algorithm has no such
  /// parameter.
  [[nodiscard]] canopen::Object object(std::uint8_t algorithm = 0) const;
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
  std::optional<canopen::Object> object_;
  std::optional<std::uint8_t> slot_;
  std::string parameter_;
};

/// The text of an address: "0x6064", "0x1018:4".
[[nodiscard]] std::string address_text(canopen::Address address);

/// The text of a value that a module has sent: "40 deg", "0x50524F4C (1347571532)", "Proleg joint module". If its size
/// differs from that of its type, the text shows the bytes.
[[nodiscard]] std::string value_text(const canopen::Object& object, std::span<const std::uint8_t> bytes);

/// Reads a value: a number in the unit of the object ("40", "0.5"), the number that is sent as hexadecimal digits
/// after 0x, or a text. Returns the bytes that are sent. Throws InputError, which names `where`, if the text is not
/// such a value, does not fit, or is outside of the declared range.
[[nodiscard]] std::vector<std::uint8_t> parse_value(const std::string& where, const canopen::Object& object,
                                                    std::string_view word);

/// Reads node ids: "3", "1,3", "2-5", "1,3-5", or "all" (then nothing is returned). Throws InputError, which names
/// `where`.
[[nodiscard]] std::optional<std::vector<std::uint8_t>> parse_nodes(std::string_view word,
                                                                   const std::string& where = "NODE");

}  // namespace proleg::host
