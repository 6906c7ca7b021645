#include "tools/proleg/describe/object_files.hpp"

#include <set>
#include <string_view>
#include <vector>

#include "shared/canopen/object_name.hpp"
#include "shared/canopen/objects.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::tools {
namespace {

using namespace proleg::canopen;

/// Date of version 1.0 of the protocol.
constexpr const char* date = "11-20-2026";
constexpr const char* time_of_day = "12:00PM";

bool is_between(std::uint16_t index, unsigned first, unsigned last) { return index >= first && index <= last; }

/// The objects in a PDO, with the fields of a mapping parameter.
struct Mapped {
  std::set<std::uint32_t> receive;
  std::set<std::uint32_t> transmit;

  Mapped() {
    for_each_object([&](const Object& object) {
      if (object.address.sub > 0 && is_between(object.address.index, 0x1600, 0x17FF)) {
        receive.insert(object.default_value);
      } else if (object.address.sub > 0 && is_between(object.address.index, 0x1A00, 0x1BFF)) {
        transmit.insert(object.default_value);
      }
    });
  }
  [[nodiscard]] bool contains(const Object& object) const {
    return receive.contains(mapping_of(object)) || transmit.contains(mapping_of(object));
  }
};

/// Text of a value. Signed types are decimal, because readers do not agree on negative numbers in hexadecimal.
std::string number(DataType type, std::uint32_t value) {
  return is_signed(type) ? std::to_string(static_cast<std::int32_t>(value)) : hexadecimal(value, 2U * size_of(type));
}

const char* access_type(const Object& object, const Mapped& mapped) {
  switch (object.access) {
    case Access::constant:
      return "const";
    case Access::read_only:
      return "ro";
    case Access::by_pdo:
      return "rww";
    case Access::write_only:
      return "wo";
    case Access::read_write:
      break;
  }
  return mapped.receive.contains(mapping_of(object)) ? "rww" : "rw";
}

/// Lowest and highest of all values allowed.
Range outer_range(const Object& object) {
  Range range{object.minimum, object.maximum};
  if (object.also_allowed) {
    range.minimum = is_less(object.type, *object.also_allowed, range.minimum) ? *object.also_allowed : range.minimum;
    range.maximum = is_less(object.type, range.maximum, *object.also_allowed) ? *object.also_allowed : range.maximum;
  }
  return range;
}

/// Whether the value is a command to the module: a tool that downloads all values must not write it.
bool is_command(const Object& object) {
  return object.address == object::store_parameters.address || object.address == object::restore_parameters.address;
}

/// Whether the file has a default value. A value that only the module changes has one if there is a usual value.
bool has_default(const Object& object) {
  return object.access == Access::constant || object.access == Access::read_write ||
         (object.access == Access::read_only && object.default_value != 0);
}

/// The keys of python-canopen, for which CiA 306 has none.
void print_units(std::ostream& out, const Object& object) {
  const UnitScale& scale = object.scale;
  if (scale.numerator != scale.denominator) {
    out << "Factor=" << exact_text(static_cast<double>(scale.denominator) / static_cast<double>(scale.numerator))
        << '\n';
  }
  if (const std::string_view symbol = scale.symbol; !symbol.empty() && symbol != scale_of(Unit::ratio).symbol) {
    out << "Unit=" << symbol << '\n';
  }
  if (!object.help.empty()) {
    out << "Description=" << object.help << '\n';
  }
}

void print_entry(std::ostream& out, const Object& object, const Mapped& mapped, EdsKeys keys) {
  out << "ParameterName=" << entry_name(object.address).view()
      << "\nObjectType=0x7\nDataType=" << hexadecimal(static_cast<std::uint32_t>(object.type), 4)
      << "\nAccessType=" << access_type(object, mapped) << '\n';
  if (is_long(object.type)) {
    if (!object.text.empty()) {
      out << "DefaultValue=" << object.text << '\n';
    }
  } else if (object.adds_node_id) {
    out << "DefaultValue=$NODEID+" << number(object.type, object.default_value) << '\n';
  } else if (has_default(object)) {
    out << "DefaultValue=" << number(object.type, object.default_value) << '\n';
  }
  const Range range = outer_range(object);
  const bool has_limits = object.access == Access::read_write && !is_long(object.type);
  if (has_limits && range.minimum != min_value(object.type)) {
    out << "LowLimit=" << number(object.type, range.minimum) << '\n';
  }
  if (has_limits && range.maximum != max_value(object.type)) {
    out << "HighLimit=" << number(object.type, range.maximum) << '\n';
  }
  out << "PDOMapping=" << (mapped.contains(object) ? 1 : 0) << '\n';
  if (keys == EdsKeys::with_units) {
    print_units(out, object);
  }
  if (is_command(object)) {
    out << "ObjFlags=0x1\n";  // refuse write on download (CiA 306)
  }
}

void print_index(std::ostream& out, std::uint16_t index, const Mapped& mapped, EdsKeys keys) {
  const IndexInfo info = *find_index(index);
  const std::string name = hexadecimal(index, 4).substr(2);
  out << "\n[" << name << "]\n";
  if (info.code == ObjectCode::variable) {
    print_entry(out, *find_object({index, 0}), mapped, keys);
    return;
  }
  out << "ParameterName=" << index_name(index).view()
      << "\nObjectType=" << hexadecimal(static_cast<std::uint32_t>(info.code), 1) << "\nSubNumber=" << info.max_sub + 1
      << '\n';
  for (unsigned sub = 0; sub <= info.max_sub; ++sub) {
    // The sub-index is hexadecimal (CiA 306).
    out << "\n[" << name << "sub" << hexadecimal(sub).substr(2) << "]\n";
    print_entry(out, *find_object({index, static_cast<std::uint8_t>(sub)}), mapped, keys);
  }
}

void print_list(std::ostream& out, std::string_view title, const std::vector<std::uint16_t>& indices,
                const Mapped& mapped, EdsKeys keys) {
  out << "\n[" << title << "]\nSupportedObjects=" << indices.size() << '\n';
  for (std::size_t i = 0; i < indices.size(); ++i) {
    out << i + 1 << '=' << hexadecimal(indices[i], 4) << '\n';
  }
  for (const std::uint16_t index : indices) {
    print_index(out, index, mapped, keys);
  }
}

}  // namespace

void print_eds(std::ostream& out, EdsKeys keys) {
  std::vector<std::uint16_t> mandatory;
  std::vector<std::uint16_t> optional;
  std::vector<std::uint16_t> manufacturer;
  unsigned receive_pdos = 0;
  unsigned transmit_pdos = 0;
  for_each_object([&](const Object& object) {
    const std::uint16_t index = object.address.index;
    if (object.address.sub != 0) {
      return;
    }
    receive_pdos += is_between(index, 0x1400, 0x15FF) ? 1U : 0U;
    transmit_pdos += is_between(index, 0x1800, 0x19FF) ? 1U : 0U;
    if (index == object::device_type.address.index || index == object::error_register.address.index ||
        index == object::identity.index) {
      mandatory.push_back(index);
    } else {
      (is_between(index, 0x2000, 0x5FFF) ? manufacturer : optional).push_back(index);
    }
  });

  out << "[FileInfo]\nFileName=proleg.eds\nFileVersion=1\nFileRevision=0\nEDSVersion=4.0\n"
         "Description=Joint module of a modular robot\nCreationTime="
      << time_of_day << "\nCreationDate=" << date
      << "\nCreatedBy=proleg objects --eds\nModificationTime=" << time_of_day << "\nModificationDate=" << date
      << "\nModifiedBy=proleg objects --eds\n\n[DeviceInfo]\nVendorName=Proleg\nVendorNumber="
      << number(DataType::unsigned32, object::vendor.default_value)
      << "\nProductName=Proleg joint module\nProductNumber=0x00000001\nRevisionNumber="
      << number(DataType::unsigned32, object::revision.default_value) << "\nOrderCode=\n";
  for (const int rate : {10, 20, 50, 125, 250, 500, 800, 1000}) {
    out << "BaudRate_" << rate << '=' << (rate == 1000 ? 1 : 0) << '\n';
  }
  out << "SimpleBootUpMaster=0\nSimpleBootUpSlave=1\nGranularity=0\nDynamicChannelsSupported=0\nCompactPDO=0\n"
         "GroupMessaging=0\nNrOfRXPDO="
      << receive_pdos << "\nNrOfTXPDO=" << transmit_pdos << "\nLSS_Supported=1\n\n[DummyUsage]\n";
  for (int type = 1; type <= 7; ++type) {
    out << "Dummy000" << type << "=0\n";
  }
  out << "\n[Comments]\nLines=2\nLine1=Written from the declarations in shared/canopen and shared/gait.\n"
      << (keys == EdsKeys::with_units
              ? "Line2=Factor, Unit and Description are for python-canopen.\n"
              : "Line2=Units and help texts for python-canopen: proleg objects --eds --units\n");

  const Mapped mapped;
  print_list(out, "MandatoryObjects", mandatory, mapped, keys);
  print_list(out, "OptionalObjects", optional, mapped, keys);
  print_list(out, "ManufacturerObjects", manufacturer, mapped, keys);
}

}  // namespace proleg::tools
