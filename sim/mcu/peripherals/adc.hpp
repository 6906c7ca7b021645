#pragma once

// ADC1 with the registers common to all ADCs (RM0090, section 13): conversions started by software, and of the regular
// group by TIM3's trigger output, with DMA. VDDA is 3.3 V.

#include <array>
#include <cstdint>
#include <optional>

#include "sim/mcu/peripherals/dma.hpp"
#include "sim/mcu/peripherals/register_block.hpp"
#include "sim/mcu/peripherals/timer.hpp"

namespace proleg::sim {

inline constexpr std::uint32_t vdda_uv = 3'300'000;
inline constexpr std::uint32_t vrefint_uv = 1'210'000;  ///< DS8626, embedded reference voltage: typical

/// Code of 12 bits for a voltage in microvolts. The converter is ideal: steps lie in the middle between the codes
/// (DS8626, ADC accuracy).
[[nodiscard]] constexpr std::uint16_t adc_code(std::uint64_t uv) {
  constexpr std::uint64_t codes = 4096;
  const std::uint64_t code = (uv * codes + vdda_uv / 2) / vdda_uv;
  return static_cast<std::uint16_t>(code < codes ? code : codes - 1);
}

/// Voltage of the temperature sensor, in microvolts, at thousandths of a degree Celsius: 0.76 V at 25 degrees, 2.5 mV a
/// degree (DS8626, temperature sensor characteristics: typical).
[[nodiscard]] constexpr std::uint32_t temperature_sensor_uv(std::int32_t millidegrees) {
  const std::int64_t uv = 760'000 + (std::int64_t{millidegrees} - 25'000) * 5 / 2;
  return static_cast<std::uint32_t>(uv < 0 ? 0 : uv);
}

/// The converter takes a voltage when advance(), or an access to a register, ends its conversion: the caller that
/// changes a voltage must call advance() before.
class Adc final : public RegisterBlock, public TriggerInput, private DmaPeripheral {
 public:
  static constexpr unsigned interrupt_position = 18;
  static constexpr unsigned dma_stream = 0;  ///< of DMA2 (RM0090, table 43)
  // Durations (DS8626, ADC characteristics).
  static constexpr LocalTime stabilisation = 3 * local_time_per_us;     ///< after ADON
  static constexpr LocalTime sensor_start = 10 * local_time_per_us;     ///< after TSVREFE
  static constexpr LocalTime sensor_sampling = 10 * local_time_per_us;  ///< of channels 16 and 17, at least

  /// dma: DMA2, which takes the results of the regular group, and must outlive the ADC. Without it DMA is rejected.
  Adc(ChipServices& chip, BoardSignals& board, Dma* dma = nullptr);

  /// Name of a register: "ADC1_CR2", "ADC_CCR"; of a converter that the board does not use "ADC2 at offset 0x4".
  [[nodiscard]] std::string register_name(std::uint32_t offset) const override;
  [[nodiscard]] std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void reset() override;
  [[nodiscard]] LocalTime next_event() const override;
  [[nodiscard]] LocalTime next_visible_event() const override;
  void advance() override;
  void clocks_change(const Clocks& next) override;
  void clocks_fail(const Clocks& next) override;

  /// Receives the trigger output of TIM3.
  void trigger(LocalTime time) override;
  [[nodiscard]] bool works_unseen() const override;

  /// Sets whether DMA reaches the data register. While it does not, the second result of the regular group is an
  /// overrun. This outlasts the failure: there are no triggers and no requests of DMA until the program has started the
  /// stream again and has cleared OVR (13.8.1).
  void set_dma_reach(bool reaches);

 private:
  enum class Group : std::uint8_t { none, regular, injected };

  [[nodiscard]] bool requests_dma() const override;
  [[nodiscard]] std::uint16_t dma_read() override;
  void dma_starts() override;
  void settle();
  void finish_conversions(LocalTime until);
  void finish_conversion();
  void finish_regular(std::uint16_t code, bool has_more);
  void begin_conversion(LocalTime begin);
  void start_group(Group group, std::uint32_t value, LocalTime time);
  [[nodiscard]] unsigned length(Group group) const;
  [[nodiscard]] unsigned channel(Group group, unsigned rank) const;
  [[nodiscard]] LocalTime clock_period() const;
  [[nodiscard]] LocalTime sampling_time(unsigned channel) const;
  void check_channel(unsigned channel, std::uint32_t value, LocalTime time) const;
  [[nodiscard]] std::uint16_t convert(unsigned channel);
  void write_cr1(std::uint32_t value);
  void write_cr2(std::uint32_t value);
  void write_ccr(std::uint32_t value);
  void update_interrupt();

  BoardSignals* board_;
  Dma* dma_;
  InterruptLine interrupt_;
  std::uint32_t sr_ = 0;
  std::uint32_t cr1_ = 0;
  std::uint32_t cr2_ = 0;
  std::array<std::uint32_t, 2> smpr_{};
  std::array<std::uint32_t, 4> jofr_{};
  std::uint32_t htr_ = 0;
  std::uint32_t ltr_ = 0;
  std::array<std::uint32_t, 3> sqr_{};
  std::uint32_t jsqr_ = 0;
  std::array<std::uint32_t, 4> jdr_{};
  std::uint32_t dr_ = 0;
  std::uint32_t ccr_ = 0;
  LocalTime on_since_ = 0;
  LocalTime sensors_since_ = 0;

  Group converting_ = Group::none;
  bool dma_reaches_ = true;
  bool has_refused_dma_ = false;  ///< OVR was set while DMA was on, and the stream has not started since
  LocalTime conversion_end_ = never_on_chip;
  unsigned regular_rank_ = 0;  ///< the rank that is converted, or continues after the injected group
  unsigned injected_rank_ = 0;
  bool regular_waits_ = false;     ///< it waits for the end of the injected group
  bool accepts_triggers_ = false;  ///< a trigger has passed all checks with the present registers and clocks
};

}  // namespace proleg::sim
