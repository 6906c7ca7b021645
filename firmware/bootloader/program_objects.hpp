#pragma once

// The object dictionary of the bootloader: the entries of CiA 302-3 (program download), and the identity.

#include <array>

#include "shared/canopen/declared_objects.hpp"

namespace proleg::bootloader::object {

using canopen::DataType;
using canopen::Object;

/// A host recognises the bootloader by this value: it has no device profile.
inline constexpr Object device_type = canopen::constant({0x1000, 0}, "Device type", DataType::unsigned32, 0,
                                                        "0: the bootloader, which is no servo drive");
inline constexpr Object error_register = canopen::constant({0x1001, 0}, "Error register", DataType::unsigned8, 0);

/// Program data (CiA 302-3, 1F50h): an image as a file contains it, header included.
inline constexpr Object program_data{
    {{0x1F50, 1}, DataType::domain, canopen::Access::write_only, false, 0, 1, 0xFFFFFFFF, {}},
    "Program data",
    "an image; it is installed when it is complete and right"};
/// Values of the program control (CiA 302-3, 1F51h).
inline constexpr std::uint8_t control_stop = 0;
inline constexpr std::uint8_t control_start = 1;
inline constexpr std::uint8_t control_reset = 2;
inline constexpr std::uint8_t control_clear = 3;
inline constexpr Object program_control = canopen::read_write(
    {0x1F51, 1}, "Program control", DataType::unsigned8, control_stop, {control_stop, control_clear},
    "1 and 2: starts the program; 0 and 3 have no effect: the old program stays until a new one is complete");
/// Identification of the program (CiA 302-3, 1F56h).
inline constexpr Object program_identification =
    canopen::read_only({0x1F56, 1}, "Program software identification", DataType::unsigned32,
                       "CRC-32 of the header of the image in slot A; 0: there is none");
/// Bits of the flash status (CiA 302-3, 1F57h): bit 0: in progress, bits 1 to 7: error.
inline constexpr std::uint32_t status_in_progress = 1;
inline constexpr std::uint32_t status_unknown_format = 2U << 1U;
inline constexpr std::uint32_t status_wrong_data = 3U << 1U;
inline constexpr std::uint32_t status_write_error = 5U << 1U;
inline constexpr std::uint32_t status_other_error = 63U << 1U;
inline constexpr Object flash_status =
    canopen::read_only({0x1F57, 1}, "Flash status identification", DataType::unsigned32,
                       "bit 0: in progress; bits 1 to 7: error; bits 8 to 15: why the image was refused");

/// All entries, without texts, for which a bootloader has no room.
inline constexpr std::array<canopen::Entry, 13> entries{
    device_type,
    error_register,
    canopen::object::heartbeat_period,
    canopen::object::vendor,
    canopen::object::product,
    canopen::object::revision,
    canopen::object::serial,
    program_data,
    program_control,
    program_identification,
    flash_status,
    canopen::object::version,
    canopen::object::board_id,
};

}  // namespace proleg::bootloader::object
