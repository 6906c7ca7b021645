#pragma once

// The firmware of a joint module, and a module that runs the flashed image in a virtual chip.

#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "firmware/stm32f405/boards/profile.hpp"
#include "sim/hardware_loop/hardware_loop.hpp"
#include "sim/mcu/chip/stm32f405.hpp"
#include "sim/mcu/cpu/back_trace.hpp"
#include "sim/mcu/cpu/flash_image.hpp"

namespace proleg::sim {

/// The firmware of a joint module, as linked for a board with an STM32F405 (firmware/stm32f405).
class FirmwareImage {
 public:
  /// Reads an ELF file. Throws ElfError if it is not a program for this chip, or not that of a joint module: one line
  /// that names the file, what was found and what was expected.
  explicit FirmwareImage(const std::filesystem::path& file);

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  [[nodiscard]] const FlashImage& flash() const { return flash_; }
  /// The image that is flashed over the bus, with its header (shared/image/image_header.hpp). The build writes the same
  /// bytes to the file with the name .pimg.
  [[nodiscard]] std::vector<std::uint8_t> image() const;
  /// The board that the image's header names; the reference board if this version of the program does not know it, so
  /// that the bootloader can refuse the image.
  [[nodiscard]] const stm32f405::BoardProfile& board() const { return *board_; }
  /// Address of the record of the module's last tick (firmware/module/tick_record.hpp).
  [[nodiscard]] std::uint32_t tick_record() const { return tick_record_; }

 private:
  std::filesystem::path file_;
  FlashImage flash_;
  const stm32f405::BoardProfile* board_;
  std::uint32_t tick_record_;
};

/// Instructions that a program needed for a tick.
struct TickCost {
  std::uint32_t tick;
  std::uint64_t to_state_frame;  ///< instructions from SYNC to the state frame in a mailbox; 0: none was sent
  std::uint64_t whole;           ///< instructions from SYNC to the next SYNC
};

/// Contents of a chip's flash, without the settings.
struct FlashContents {
  std::filesystem::path bootloader;  ///< ELF file of the bootloader, for back traces
  std::vector<ElfImage::Segment> parts;
};

struct VirtualModuleOptions {
  /// Contents of the flash, which must outlive the module. Null: all of the image's ELF file, which its start stub
  /// starts.
  const FlashContents* flash = nullptr;
  /// The board around the chip: its crystal, and what is connected to its pins. Null: the image's.
  const stm32f405::BoardProfile* board = nullptr;
  /// Called with each line that the program prints on its console (USART2).
  std::function<void(const std::string&)> console{};
  /// Called at the end of each tick that begins and ends with a SYNC: where the chip stands between bus events, and so
  /// what it has executed by then, depends on how far it was prepared.
  std::function<void(const TickCost&)> on_tick{};
};

class VirtualModule final : public JointModule, private BoardSignals {
 public:
  /// image must outlive the module. The board record with the node id is in flash, as a programmer writes it; node id 0
  /// means no board record. The flash keeps its contents over power_on().
  VirtualModule(const ModuleParts& parts, const FirmwareImage& image, VirtualModuleOptions options);
  ~VirtualModule() override = default;
  VirtualModule(const VirtualModule&) = delete;
  VirtualModule& operator=(const VirtualModule&) = delete;

  void power_on(BusTime now) override;
  [[nodiscard]] BusTime next_event() const override { return prepared_from_ ? *prepared_from_ : chip_.next_event(); }
  void advance_to(BusTime now, BusTime quiet_until) override;
  [[nodiscard]] bool can_prepare(BusTime from) const override;
  void submit(BusTime now) override { chip_.submit(now); }
  void prepare(BusTime from, BusTime quiet_until) override;
  void catch_up_before(BusTime time) override { chip_.catch_up_before(time); }
  void run_out(BusTime now, BusTime until) override { chip_.advance_to(now, until); }
  void set_supply(BusTime now, std::uint32_t mv) override;
  void set_adc(BusTime now, bool converts) override;
  void set_crystal(BusTime now, bool runs) override;
  void set_pll(BusTime now, bool locks) override;
  void begin_serial_input(BusTime now, const SerialCharacter& character, BusTime bit) override;
  void set_serial_watch(SerialWatch watch) override;
  [[nodiscard]] canopen::PowerState power() const override;
  void set_pulse_watch(PulseWatch watch) override;
  void set_command_watch(CommandWatch watch) override;
  [[nodiscard]] firmware::TickRecord last_tick() const override;
  [[nodiscard]] std::optional<std::int32_t> pulse() const override;
  [[nodiscard]] std::size_t controller() const override { return chip_.controller(); }
  void note_sync(std::uint32_t tick) override;
  void note_missing_sync() override { tick_.reset(); }
  [[nodiscard]] std::optional<std::string> take_problem() override;
  [[nodiscard]] bool leaves_model() const override { return leaves_model_; }

  /// The most expensive tick so far, by the instructions to the state frame.
  [[nodiscard]] const TickCost& worst_tick() const { return worst_; }
  [[nodiscard]] Stm32f405& chip() { return chip_; }

 private:
  /// Calls a function of another object: now, or at advance_to() while the module is being prepared.
  void report(std::function<void()> call);
  void see_edge(BusTime time, bool high);
  [[nodiscard]] std::optional<bool> pin(char port, unsigned number) override;
  [[nodiscard]] std::uint32_t analog_uv(unsigned channel) override;
  [[nodiscard]] std::int32_t chip_temperature() override;
  void serial_output(unsigned usart, std::uint8_t byte) override;
  [[nodiscard]] std::string describe(const ChipEvent& event);
  [[nodiscard]] std::vector<std::string> trace(const ChipEvent& event) const;

  const FirmwareImage& image_;
  VirtualModuleOptions options_;
  const stm32f405::BoardProfile& board_;
  std::function<std::uint8_t()> sensors_;
  std::function<ServoReadings()> readings_;
  std::uint16_t state_frame_;  ///< identifier of the state frame
  Stm32f405 chip_;
  std::uint64_t start_of_program_ = 0;  ///< Stm32f405::starts() when the program has last sent a frame
  std::string line_;                    ///< the part of a console line received so far
  std::optional<std::uint32_t> tick_;
  std::uint64_t sync_instructions_ = 0;
  std::uint64_t state_frame_instructions_ = 0;
  TickCost worst_{};
  bool has_clock_ = true;      ///< crystal and PLL run, unless a fault has stopped them
  bool leaves_model_ = false;  ///< of the last problem
  bool is_pulse_whole_ = true;
  PulseWatch pulse_watch_;
  std::optional<BusTime> prepared_from_;  ///< advance_to() is due then, and has been prepared
  BusTime prepared_until_ = 0;
  bool is_preparing_ = false;                   ///< in prepare()
  std::vector<std::function<void()>> reports_;  ///< calls that wait for advance_to()
  std::exception_ptr error_;                    ///< of prepare(), for advance_to()
  std::optional<BusTime> pulse_begin_;
  canopen::PowerState power_at_begin_ = canopen::PowerState::switch_on_disabled;
};

}  // namespace proleg::sim
