#include "shared/canopen/power_state.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <random>

namespace proleg::canopen {
namespace {

using enum PowerState;

/// A row of the standard's command coding: the relevant bits and their values.
struct DriveCommand {
  const char* name;
  unsigned mask;
  unsigned value;
};
// CiA 402, "Command coding". Bit 7 of a fault reset is tested separately: its edge counts.
constexpr DriveCommand shutdown{"shutdown", 0x87, 0x06};
constexpr DriveCommand switch_on{"switch on", 0x8F, 0x07};
constexpr DriveCommand enable_operation{"enable operation", 0x8F, 0x0F};
constexpr DriveCommand disable_voltage{"disable voltage", 0x82, 0x00};
constexpr DriveCommand quick_stop{"quick stop", 0x86, 0x02};
constexpr DriveCommand disable_operation{"disable operation", 0x8F, 0x07};

/// A row of the standard's table of transitions.
struct Transition {
  int number;
  PowerState from;
  DriveCommand command;
  PowerState to;
};
constexpr Transition transitions[] = {
    {2, switch_on_disabled, shutdown, ready_to_switch_on},
    {3, ready_to_switch_on, switch_on, switched_on},
    {3 + 4, ready_to_switch_on, enable_operation, operation_enabled},  // "switch on + enable operation"
    {4, switched_on, enable_operation, operation_enabled},
    {5, operation_enabled, disable_operation, switched_on},
    {6, switched_on, shutdown, ready_to_switch_on},
    {7, ready_to_switch_on, quick_stop, switch_on_disabled},
    {7, ready_to_switch_on, disable_voltage, switch_on_disabled},
    {8, operation_enabled, shutdown, ready_to_switch_on},
    {9, operation_enabled, disable_voltage, switch_on_disabled},
    {10, switched_on, quick_stop, switch_on_disabled},
    {10, switched_on, disable_voltage, switch_on_disabled},
    {11, operation_enabled, quick_stop, quick_stop_active},
    {12, quick_stop_active, disable_voltage, switch_on_disabled},
};
constexpr PowerState states[] = {switch_on_disabled, ready_to_switch_on, switched_on,
                                 operation_enabled,  quick_stop_active,  fault};

/// A drive in a state. reset_bit: whether the last controlword had bit 7.
PowerControl drive_in(PowerState state, bool reset_bit = false) {
  PowerControl drive;
  if (state != switch_on_disabled && state != fault) {
    drive.command(0x06);
    if (state != ready_to_switch_on) {
      drive.command(state == switched_on ? 0x07 : 0x0F);
    }
    if (state == quick_stop_active) {
      drive.quick_stop();
    }
  }
  if (state == fault) {
    drive.fault();
  }
  if (reset_bit && state != fault && state != quick_stop_active) {
    drive.command(static_cast<std::uint16_t>(drive.controlword() | 0x80U));
  } else if (reset_bit) {
    // The bit is set first, and the cause comes afterwards.
    drive = drive_in(state == fault ? switch_on_disabled : operation_enabled, true);
    state == fault ? drive.fault() : drive.quick_stop();
  }
  EXPECT_EQ(drive.state(), state);
  return drive;
}

TEST(PowerState, FollowsTheTableOfTransitionsForEveryControlword) {
  for (const PowerState state : states) {
    for (const bool reset_bit : {false, true}) {
      for (unsigned controlword = 0; controlword <= 0xFFFF; ++controlword) {
        PowerState expected = state;
        for (const Transition& transition : transitions) {
          if (transition.from == state && (controlword & transition.command.mask) == transition.command.value) {
            expected = transition.to;
          }
        }
        const bool edge = (controlword & 0x80U) != 0 && !reset_bit;
        if (edge && (state == fault || state == quick_stop_active)) {
          expected = switch_on_disabled;
        }
        PowerControl drive = drive_in(state, reset_bit);
        drive.command(static_cast<std::uint16_t>(controlword));
        ASSERT_EQ(drive.state(), expected) << "from state " << static_cast<int>(state) << " by controlword "
                                           << controlword << (reset_bit ? ", bit 7 was set" : "");
        ASSERT_EQ(drive.controlword(), controlword);
      }
    }
  }
}

TEST(PowerState, StatuswordCodesTheStateAsTheStandardHasIt) {
  struct Coding {
    PowerState state;
    unsigned mask;
    unsigned value;
  };
  // CiA 402, "State coding".
  constexpr Coding codings[] = {
      {switch_on_disabled, 0x4F, 0x40}, {ready_to_switch_on, 0x6F, 0x21}, {switched_on, 0x6F, 0x23},
      {operation_enabled, 0x6F, 0x27},  {quick_stop_active, 0x6F, 0x07},  {fault, 0x4F, 0x08},
  };
  for (const PowerState state : states) {
    const unsigned statusword = drive_in(state).statusword();
    for (const Coding& coding : codings) {
      EXPECT_EQ((statusword & coding.mask) == coding.value, coding.state == state)
          << "state " << static_cast<int>(state) << ", statusword " << statusword;
    }
    EXPECT_EQ(statusword & 0x0210U, 0x0210U) << "voltage enabled, remote";
  }
}

TEST(PowerState, QuickStopTakesAPersonToEnd) {
  PowerControl drive = drive_in(operation_enabled);
  drive.quick_stop();
  EXPECT_EQ(drive.state(), quick_stop_active);
  for (int i = 0; i < 3; ++i) {
    drive.command(0x000F);  // the controlword that comes with every direct position
    EXPECT_EQ(drive.state(), quick_stop_active);
  }
  drive.command(0x0080);
  EXPECT_EQ(drive.state(), switch_on_disabled);
  drive.command(0x0006);
  drive.command(0x000F);
  EXPECT_EQ(drive.state(), operation_enabled);
}

TEST(PowerState, OnlyAnEnabledDriveStopsQuickly) {
  for (const PowerState state : states) {
    PowerControl drive = drive_in(state);
    drive.quick_stop();
    EXPECT_EQ(drive.state(), state == operation_enabled ? quick_stop_active : state);
  }
}

TEST(PowerState, AFaultIsClearedByARisingEdgeOfBit7Alone) {
  for (const PowerState state : states) {
    PowerControl drive = drive_in(state);
    drive.fault();
    EXPECT_EQ(drive.state(), fault);
  }
  PowerControl drive = drive_in(fault, true);
  drive.command(0x0080);
  EXPECT_EQ(drive.state(), fault) << "the bit has been set all the time";
  drive.command(0x000F);
  drive.command(0x0006);
  EXPECT_EQ(drive.state(), fault);
  drive.command(0x0080);
  EXPECT_EQ(drive.state(), switch_on_disabled);
  drive.command(0x0086);
  EXPECT_EQ(drive.state(), switch_on_disabled) << "commands need bit 7 cleared";
}

TEST(PowerState, WithoutVoltageOnlyTheHostEnablesTheDriveAgain) {
  for (const PowerState state : states) {
    PowerControl drive = drive_in(state);
    drive.disable_voltage();
    EXPECT_EQ(drive.state(), state == fault ? fault : switch_on_disabled);
    drive.command(0x000F);
    EXPECT_EQ(drive.state(), state == fault ? fault : switch_on_disabled) << "without Ready to switch on before";
  }
}

TEST(PowerState, ResetIsAsAfterSwitchingOn) {
  PowerControl drive = drive_in(quick_stop_active);
  drive.reset();
  EXPECT_EQ(drive.state(), switch_on_disabled);
  EXPECT_EQ(drive.controlword(), 0);
  EXPECT_EQ(drive.statusword(), PowerControl().statusword());
}

}  // namespace
}  // namespace proleg::canopen
