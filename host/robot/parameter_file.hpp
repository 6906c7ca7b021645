#pragma once

// A text file with the settings of modules, one in a line, for people and for version control:
//
//   # Proleg parameters 1
//   module <TAB> node <TAB> serial number <TAB> core fingerprint
//   3 <TAB> 0x6080 <TAB> 720 <TAB> Max motor speed
//
// The first line is fixed. A `module` line comes before the values of its node. Values are in the unit of the object,
// as `proleg set` takes them; the name is for the reader. Empty lines and other lines that begin with # are comments.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "shared/canopen/objects.hpp"

namespace proleg::host {

/// The first bytes of such a file, of any version.
inline constexpr std::string_view parameter_file_start = "# Proleg parameters";

struct ParameterValue {
  canopen::Object object;
  std::vector<std::uint8_t> bytes;  ///< bytes of the value in SDO transfers

  friend bool operator==(const ParameterValue& left, const ParameterValue& right) {
    return left.object.address == right.object.address && left.bytes == right.bytes;
  }
};

struct ModuleParameters {
  std::uint8_t node = 0;
  std::uint32_t serial = 0;
  std::uint32_t core_fingerprint = 0;
  std::vector<ParameterValue> values;  ///< values, each of another object

  friend bool operator==(const ModuleParameters&, const ModuleParameters&) = default;
};

/// Reads the text of a file. file: its name, for messages. Throws InputError with the line if the text is not such a
/// file; it may have at most 126 modules.
[[nodiscard]] std::vector<ModuleParameters> read_parameters(const std::string& file, std::string_view text);

/// The text of a file, from which read_parameters() makes the same modules.
[[nodiscard]] std::string parameters_text(const std::vector<ModuleParameters>& modules);

/// The objects that are the settings of a module: those that it keeps in flash except its node id, the greatest speed,
/// and the parameters of its algorithms. algorithms: ids by slot, 0: none.
[[nodiscard]] std::vector<canopen::Object> setting_objects(const std::vector<std::uint8_t>& algorithms);

/// The setting objects that the module keeps in flash.
[[nodiscard]] std::vector<canopen::Object> kept_objects();

}  // namespace proleg::host
