#pragma once

// How people name an object of a module, and how its value looks to them.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/canopen/objects.hpp"

namespace proleg::host {

/// The words for an object:
///   0x6064, 6064, 0x1018:4, 1018:4   index and sub-index, hexadecimal and decimal
///   "Joint index"                    the name of the object dictionary, in any case; with that of its index if several
///                                    entries have the name: "Place in the robot: Joint index"
///   amplitude, amplitude:2           a parameter of the algorithm in slot 1, or another slot, of that module
class ObjectWord {
 public:
  /// Throws InputError for a word that names no object, or several.
  explicit ObjectWord(std::string_view word);

  /// The slot (0 to 3) whose algorithm decides which object it is; nothing: object() needs no algorithm.
  [[nodiscard]] std::optional<std::uint8_t> slot() const { return slot_; }
  /// The object. algorithm: id in the slot, 0: none. Throws InputError if the algorithm has no such parameter.
  [[nodiscard]] canopen::Object object(std::uint8_t algorithm = 0) const;
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
  std::optional<canopen::Object> object_;
  std::optional<std::uint8_t> slot_;
  std::string parameter_;
};

/// "0x6064", "0x1018:4"
[[nodiscard]] std::string address_text(canopen::Address address);

/// A value as a module sends it: "40 deg", "0x50524F4C (1347571532)", "Proleg joint module". Of another size than that
/// of its type: the bytes.
[[nodiscard]] std::string value_text(const canopen::Object& object, std::span<const std::uint8_t> bytes);

/// A number in the unit of the object ("40", "0.5"), as hexadecimal digits after 0x of the number that travels, or a
/// text. Returns the bytes that travel. Throws InputError, which names `where`, if it is none, does not fit, or is
/// outside of the declared range.
[[nodiscard]] std::vector<std::uint8_t> parse_value(const std::string& where, const canopen::Object& object,
                                                    std::string_view word);

/// Node ids: "3", "1,3", "2-5", "1,3-5", or "all" (nothing is returned then). Throws InputError, which names `where`.
[[nodiscard]] std::optional<std::vector<std::uint8_t>> parse_nodes(std::string_view word,
                                                                   const std::string& where = "NODE");

}  // namespace proleg::host
