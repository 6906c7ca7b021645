#include "sim/mcu/peripherals/adc.hpp"

#include <string>

namespace proleg::sim {
namespace {

constexpr std::uint32_t sr = 0x00;
constexpr std::uint32_t cr1 = 0x04;
constexpr std::uint32_t cr2 = 0x08;
constexpr std::uint32_t smpr1 = 0x0C;
constexpr std::uint32_t smpr2 = 0x10;
constexpr std::uint32_t jofr1 = 0x14;
constexpr std::uint32_t jofr4 = 0x20;
constexpr std::uint32_t htr = 0x24;
constexpr std::uint32_t ltr = 0x28;
constexpr std::uint32_t sqr1 = 0x2C;
constexpr std::uint32_t sqr2 = 0x30;
constexpr std::uint32_t sqr3 = 0x34;
constexpr std::uint32_t jsqr = 0x38;
constexpr std::uint32_t jdr1 = 0x3C;
constexpr std::uint32_t jdr4 = 0x48;
constexpr std::uint32_t dr = 0x4C;
constexpr std::uint32_t csr = 0x300;
constexpr std::uint32_t ccr = 0x304;
constexpr std::uint32_t cdr = 0x308;
constexpr RegisterName registers[] = {
    {sr, "SR"},      {cr1, "CR1"},    {cr2, "CR2"},     {smpr1, "SMPR1"}, {smpr2, "SMPR2"}, {jofr1, "JOFR1"},
    {0x18, "JOFR2"}, {0x1C, "JOFR3"}, {jofr4, "JOFR4"}, {htr, "HTR"},     {ltr, "LTR"},     {sqr1, "SQR1"},
    {sqr2, "SQR2"},  {sqr3, "SQR3"},  {jsqr, "JSQR"},   {jdr1, "JDR1"},   {0x40, "JDR2"},   {0x44, "JDR3"},
    {jdr4, "JDR4"},  {dr, "DR"},      {csr, "CSR"},     {ccr, "CCR"},     {cdr, "CDR"}};
constexpr std::uint32_t adc_size = 0x100;
constexpr std::uint32_t common = 0x300;

constexpr std::uint32_t sr_eoc = 1U << 1U;
constexpr std::uint32_t sr_jeoc = 1U << 2U;
constexpr std::uint32_t sr_jstrt = 1U << 3U;
constexpr std::uint32_t sr_strt = 1U << 4U;
constexpr std::uint32_t sr_ovr = 1U << 5U;

constexpr std::uint32_t cr1_eocie = 1U << 5U;
constexpr std::uint32_t cr1_jeocie = 1U << 7U;
constexpr std::uint32_t cr1_scan = 1U << 8U;
constexpr std::uint32_t cr1_jauto = 1U << 10U;
constexpr std::uint32_t cr1_discontinuous = 3U << 11U;
constexpr std::uint32_t cr1_watchdog = 3U << 22U;
constexpr std::uint32_t cr1_resolution = 3U << 24U;
constexpr std::uint32_t cr1_ovrie = 1U << 26U;
constexpr std::uint32_t cr1_interrupts = cr1_eocie | cr1_jeocie | cr1_ovrie;
constexpr std::uint32_t cr1_bits = 0x07C0'FFFF;

constexpr std::uint32_t cr2_adon = 1U << 0U;
constexpr std::uint32_t cr2_cont = 1U << 1U;
constexpr std::uint32_t cr2_dma = 1U << 8U;
constexpr std::uint32_t cr2_eocs = 1U << 10U;
constexpr std::uint32_t cr2_align = 1U << 11U;
constexpr std::uint32_t cr2_dds = 1U << 9U;
constexpr std::uint32_t cr2_injected_triggers = 3U << 20U;
constexpr std::uint32_t cr2_regular_triggers = 3U << 28U;
constexpr std::uint32_t cr2_rising_edge = 1U << 28U;
constexpr std::uint32_t cr2_regular_source = 15U << 24U;
constexpr std::uint32_t cr2_tim3_trgo = 8U << 24U;  // RM0090, table 68
constexpr std::uint32_t cr2_jswstart = 1U << 22U;
constexpr std::uint32_t cr2_swstart = 1U << 30U;
constexpr std::uint32_t cr2_kept = 0x3F0F'0F03;

constexpr std::uint32_t ccr_multi = 0x1F;
constexpr std::uint32_t ccr_dma = 7U << 13U;
constexpr std::uint32_t ccr_prescaler = 3U << 16U;
constexpr std::uint32_t ccr_vbate = 1U << 22U;
constexpr std::uint32_t ccr_tsvrefe = 1U << 23U;
constexpr std::uint32_t ccr_kept = 0x0083'0F00;

constexpr unsigned dma_channel = 0;  // RM0090, table 43
constexpr std::uint32_t adc1_dr = 0x4001'204C;

constexpr unsigned temperature_channel = 16;
constexpr unsigned vrefint_channel = 17;
constexpr unsigned vbat_channel = 18;
constexpr LocalTime conversion_cycles = 12;

// The clock of the converter has 0.6 to 36 MHz (DS8626).
constexpr LocalTime min_clock_period = 28;
constexpr LocalTime max_clock_period = 1680;

}  // namespace

Adc::Adc(ChipServices& chip, BoardSignals& board, Dma* dma)
    : RegisterBlock(chip, "ADC1", 0x4001'2000, 0x400, registers),
      board_(&board),
      dma_(dma),
      interrupt_(chip, interrupt_position) {
  if (dma_ != nullptr) {
    dma_->connect({dma_stream, dma_channel, Dma::Direction::from_peripheral, 2, adc1_dr}, *this);
  }
  Adc::reset();
}

bool Adc::requests_dma() const {
  return dma_reaches_ && !has_refused_dma_ && (sr_ & sr_ovr) == 0 && (cr2_ & cr2_dma) != 0 && (sr_ & sr_eoc) != 0;
}

void Adc::dma_starts() { has_refused_dma_ = false; }

std::uint16_t Adc::dma_read() {
  sr_ &= ~sr_eoc;
  return static_cast<std::uint16_t>(dr_);
}

std::string Adc::register_name(std::uint32_t offset) const {
  if (offset >= common) {
    for (const RegisterName& candidate : registers) {
      if (candidate.offset == offset) {
        return "ADC_" + std::string(candidate.name);
      }
    }
    return "ADC at offset " + hexadecimal(offset);
  }
  if (offset >= adc_size) {
    return "ADC" + std::to_string(offset / adc_size + 1) + " at offset " + hexadecimal(offset % adc_size);
  }
  return RegisterBlock::register_name(offset);
}

void Adc::reset() {
  sr_ = 0;
  cr1_ = 0;
  cr2_ = 0;
  smpr_ = {};
  jofr_ = {};
  htr_ = 0xFFF;
  ltr_ = 0;
  sqr_ = {};
  jsqr_ = 0;
  jdr_ = {};
  dr_ = 0;
  ccr_ = 0;
  converting_ = Group::none;
  conversion_end_ = never_on_chip;
  regular_waits_ = false;
  accepts_triggers_ = false;
  has_refused_dma_ = false;
  interrupt_.set(false);
}

LocalTime Adc::next_event() const { return conversion_end_; }

LocalTime Adc::next_visible_event() const { return (cr1_ & cr1_interrupts) == 0 ? never_on_chip : conversion_end_; }

bool Adc::works_unseen() const {
  return (cr1_ & cr1_interrupts) == 0 && ((cr2_ & cr2_regular_triggers) == 0 || accepts_triggers_);
}

void Adc::advance() { settle(); }

void Adc::settle() {
  finish_conversions(chip().now());
  update_interrupt();
}

void Adc::finish_conversions(LocalTime until) {
  while (conversion_end_ <= until) {
    finish_conversion();
  }
}

void Adc::update_interrupt() {
  interrupt_.set(((sr_ & sr_eoc) != 0 && (cr1_ & cr1_eocie) != 0) ||
                 ((sr_ & sr_jeoc) != 0 && (cr1_ & cr1_jeocie) != 0) ||
                 ((sr_ & sr_ovr) != 0 && (cr1_ & cr1_ovrie) != 0));
}

void Adc::clocks_change(const Clocks& next) {
  settle();
  accepts_triggers_ = false;
  if (converting_ != Group::none && next.apb2 != chip().clocks().apb2) {
    throw UnmodelledAccess("ADC1 converts while PCLK2 changes");
  }
}

void Adc::trigger(LocalTime time) {
  finish_conversions(time);
  // Without a clock (the PLL has failed) the converter does not see the trigger.
  const bool has_clock = clock_period() < local_time_per_us * 1'000;
  if (has_clock && (cr2_ & cr2_regular_triggers) != 0 && converting_ != Group::regular && !regular_waits_) {
    start_group(Group::regular, cr2_, time);
    accepts_triggers_ = true;
    chip().reschedule();
  }
  update_interrupt();
}

void Adc::set_dma_reach(bool reaches) {
  settle();
  dma_reaches_ = reaches;
  if (reaches && dma_ != nullptr) {
    dma_->serve(dma_stream);
  }
}

void Adc::clocks_fail(const Clocks& /*next*/) {
  settle();
  converting_ = Group::none;
  conversion_end_ = never_on_chip;
  regular_waits_ = false;
  accepts_triggers_ = false;
}

LocalTime Adc::clock_period() const { return chip().clocks().apb2 * 2 * (LocalTime{field(ccr_, 16, 2)} + 1); }

LocalTime Adc::sampling_time(unsigned channel) const {
  constexpr LocalTime cycles[] = {3, 15, 28, 56, 84, 112, 144, 480};
  constexpr unsigned channels_in_smpr2 = 10;
  const unsigned setting = channel < channels_in_smpr2 ? field(smpr_[1], 3 * channel, 3)
                                                       : field(smpr_[0], 3 * (channel - channels_in_smpr2), 3);
  return cycles[setting] * clock_period();
}

unsigned Adc::length(Group group) const {
  return (group == Group::regular ? field(sqr_[0], 20, 4) : field(jsqr_, 20, 2)) + 1;
}

unsigned Adc::channel(Group group, unsigned rank) const {
  constexpr unsigned ranks_in_register = 6;
  constexpr unsigned injected_ranks = 4;
  if (group == Group::regular) {
    // SQR3 has the first ranks.
    return field(sqr_[2 - rank / ranks_in_register], 5 * (rank % ranks_in_register), 5);
  }
  // The last rank is always JSQ4.
  return field(jsqr_, 5 * (injected_ranks - length(group) + rank), 5);
}

void Adc::check_channel(unsigned channel, std::uint32_t value, LocalTime time) const {
  if (channel >= vbat_channel) {
    reject_write(cr2, value, "channel " + std::to_string(channel) + " is not modelled");
  }
  if (channel < temperature_channel) {
    return;
  }
  const std::string name = "channel " + std::to_string(channel);
  if ((ccr_ & ccr_tsvrefe) == 0) {
    reject_write(cr2, value, name + " without TSVREFE");
  }
  if (time - sensors_since_ < sensor_start) {
    reject_write(cr2, value, name + " earlier than 10 us after TSVREFE");
  }
  if (sampling_time(channel) < sensor_sampling) {
    reject_write(cr2, value, name + " sampled for less than 10 us");
  }
}

std::uint16_t Adc::convert(unsigned channel) {
  switch (channel) {
    case temperature_channel:
      return adc_code(temperature_sensor_uv(board_->chip_temperature()));
    case vrefint_channel:
      return adc_code(vrefint_uv);
    default:
      return adc_code(board_->analog_uv(channel));
  }
}

void Adc::begin_conversion(LocalTime begin) {
  const unsigned rank = converting_ == Group::regular ? regular_rank_ : injected_rank_;
  conversion_end_ = begin + sampling_time(channel(converting_, rank)) + conversion_cycles * clock_period();
}

void Adc::finish_conversion() {
  const LocalTime end = conversion_end_;
  const Group group = converting_;
  const unsigned rank = group == Group::regular ? regular_rank_++ : injected_rank_++;
  const std::uint16_t code = convert(channel(group, rank));
  bool has_more = rank + 1 < length(group);
  if (group == Group::injected) {
    jdr_[rank] = (code - jofr_[rank]) & 0xFFFFU;
    if (!has_more) {
      sr_ |= sr_jeoc;
    }
  } else if ((cr2_ & (cr2_eocs | cr2_dma)) != 0 && (sr_ & sr_eoc) != 0) {
    sr_ |= sr_ovr;  // the data are lost, and the sequence ends (RM0090, 13.8.1 and 13.8.2)
    has_refused_dma_ = has_refused_dma_ || (cr2_ & cr2_dma) != 0;
    has_more = false;
  } else {
    finish_regular(code, has_more);
  }
  if (!has_more) {
    converting_ = group == Group::injected && regular_waits_ ? Group::regular : Group::none;
    regular_waits_ = false;
  }
  if (converting_ == Group::none) {
    conversion_end_ = never_on_chip;
  } else {
    begin_conversion(end);
  }
}

void Adc::finish_regular(std::uint16_t code, bool has_more) {
  dr_ = code;
  if ((cr2_ & cr2_dma) != 0) {
    sr_ |= sr_eoc;
    dma_->serve(dma_stream);
  } else if (!has_more || (cr2_ & cr2_eocs) != 0) {
    sr_ |= sr_eoc;
  }
}

void Adc::start_group(Group group, std::uint32_t value, LocalTime time) {
  if ((cr2_ & cr2_adon) == 0) {
    reject_write(cr2, value, "a start without ADON");
  }
  if (time - on_since_ < stabilisation) {
    reject_write(cr2, value, "a start earlier than 3 us after ADON");
  }
  if (clock_period() < min_clock_period || clock_period() > max_clock_period) {
    reject_write(
        cr2, value,
        "ADCCLK of " + std::to_string(local_time_per_us * 1000 / clock_period()) + " kHz: expected 600 to 36000 kHz");
  }
  if ((cr1_ & cr1_scan) == 0 && length(group) > 1) {
    reject_write(cr2, value, "a sequence of " + std::to_string(length(group)) + " without SCAN");
  }
  for (unsigned rank = 0; rank < length(group); ++rank) {
    check_channel(channel(group, rank), value, time);
  }
  if (group == Group::regular) {
    if ((sr_ & sr_ovr) != 0) {
      return;  // starts are ignored until OVR is cleared (RM0090, 13.8)
    }
    if (converting_ == Group::regular || regular_waits_) {
      reject_write(cr2, value, "SWSTART while the regular group is being converted");
    }
    sr_ |= sr_strt;
    regular_rank_ = 0;
    if (converting_ == Group::injected) {
      regular_waits_ = true;
      return;
    }
  } else {
    if (converting_ == Group::injected) {
      reject_write(cr2, value, "JSWSTART while the injected group is being converted");
    }
    sr_ |= sr_jstrt;
    injected_rank_ = 0;
    // The conversion that is interrupted is done again.
    regular_waits_ = converting_ == Group::regular;
  }
  converting_ = group;
  begin_conversion(time);
}

std::uint32_t Adc::read(std::uint32_t offset) {
  settle();
  switch (offset) {
    case sr:
    case csr:
      return sr_;
    case cr1:
      return cr1_;
    case cr2:
      return cr2_;
    case smpr1:
      return smpr_[0];
    case smpr2:
      return smpr_[1];
    case htr:
      return htr_;
    case ltr:
      return ltr_;
    case sqr1:
    case sqr2:
    case sqr3:
      return sqr_[(offset - sqr1) / 4];
    case jsqr:
      return jsqr_;
    case dr:
      sr_ &= ~sr_eoc;
      update_interrupt();
      return dr_;
    case ccr:
      return ccr_;
    case cdr:
      return 0;
    default:
      if (offset >= jofr1 && offset <= jofr4) {
        return jofr_[(offset - jofr1) / 4];
      }
      if (offset >= jdr1 && offset <= jdr4) {
        return jdr_[(offset - jdr1) / 4];
      }
      reject_read(offset);
  }
}

void Adc::write(std::uint32_t offset, std::uint32_t value) {
  settle();
  accepts_triggers_ = accepts_triggers_ && (offset == sr || (offset == cr2 && (value & cr2_kept) == cr2_));
  switch (offset) {
    case sr:
      sr_ &= value;
      break;
    case cr1:
      write_cr1(value);
      break;
    case cr2:
      write_cr2(value);
      break;
    case smpr1:
      smpr_[0] = value & 0x07FF'FFFFU;
      break;
    case smpr2:
      smpr_[1] = value & 0x3FFF'FFFFU;
      break;
    case htr:
      htr_ = value & 0xFFFU;
      break;
    case ltr:
      ltr_ = value & 0xFFFU;
      break;
    case sqr1:
    case sqr2:
    case sqr3:
      if (converting_ == Group::regular || regular_waits_) {
        reject_write(offset, value, "the sequence changes while it is being converted");
      }
      sqr_[(offset - sqr1) / 4] = value & (offset == sqr1 ? 0x00FF'FFFFU : 0x3FFF'FFFFU);
      break;
    case jsqr:
      if (converting_ == Group::injected) {
        reject_write(offset, value, "the sequence changes while it is being converted");
      }
      jsqr_ = value & 0x003F'FFFFU;
      break;
    case ccr:
      write_ccr(value);
      break;
    default:
      if (offset >= jofr1 && offset <= jofr4) {
        jofr_[(offset - jofr1) / 4] = value & 0xFFFU;
      } else if ((offset < jdr1 || offset > dr) && offset != csr && offset != cdr) {  // data registers are read only
        reject_write(offset, value);
      }
  }
  update_interrupt();
}

void Adc::write_cr1(std::uint32_t value) {
  reject_bits(cr1, value, cr1_watchdog, "the analog watchdog is not modelled");
  reject_bits(cr1, value, cr1_jauto | cr1_discontinuous, "automatic injection and discontinuous mode are not modelled");
  reject_bits(cr1, value, cr1_resolution, "only 12 bits are modelled");
  cr1_ = value & cr1_bits;
}

void Adc::write_cr2(std::uint32_t value) {
  if ((value & (cr2_dma | cr2_dds)) != 0 && (dma_ == nullptr || (value & cr2_dds) == 0)) {
    reject_write(cr2, value, "DMA is modelled with DDS = 1 only");
  }
  reject_bits(cr2, value, cr2_cont, "continuous conversion is not modelled");
  reject_bits(cr2, value, cr2_align, "only right alignment is modelled");
  reject_bits(cr2, value, cr2_injected_triggers, "external triggers of the injected group are not modelled");
  if ((value & cr2_regular_triggers) != 0 &&
      (value & (cr2_regular_triggers | cr2_regular_source)) != (cr2_rising_edge | cr2_tim3_trgo)) {
    reject_write(cr2, value, "of the external triggers only the rising edge of TIM3_TRGO is modelled");
  }
  const bool was_on = (cr2_ & cr2_adon) != 0;
  cr2_ = value & cr2_kept;
  if ((cr2_ & cr2_adon) == 0) {
    converting_ = Group::none;
    conversion_end_ = never_on_chip;
    regular_waits_ = false;
  } else if (!was_on) {
    on_since_ = chip().now();
  }
  if ((value & cr2_jswstart) != 0) {
    start_group(Group::injected, value, chip().now());
  }
  if ((value & cr2_swstart) != 0) {
    start_group(Group::regular, value, chip().now());
  }
}

void Adc::write_ccr(std::uint32_t value) {
  reject_bits(ccr, value, ccr_multi | ccr_dma, "several ADCs together are not modelled");
  reject_bits(ccr, value, ccr_vbate, "the battery channel is not modelled");
  if (converting_ != Group::none && ((value ^ ccr_) & ccr_prescaler) != 0) {
    reject_write(ccr, value, "ADCCLK changes during a conversion");
  }
  if ((value & ~ccr_ & ccr_tsvrefe) != 0) {
    sensors_since_ = chip().now();
  }
  ccr_ = value & ccr_kept;
}

}  // namespace proleg::sim
