#include "sim/mcu/peripherals/chip_identity.hpp"

#include <span>
#include <string_view>

#include "sim/mcu/peripherals/register_block.hpp"

namespace proleg::sim {
namespace {

struct Block {
  std::uint32_t base;
  std::uint32_t size;
  std::string_view name;
};

constexpr Block memory_map[] = {
    {0x4000'0000, 0x400, "TIM2"},      {0x4000'0400, 0x400, "TIM3"},      {0x4000'0800, 0x400, "TIM4"},
    {0x4000'0C00, 0x400, "TIM5"},      {0x4000'1000, 0x400, "TIM6"},      {0x4000'1400, 0x400, "TIM7"},
    {0x4000'1800, 0x400, "TIM12"},     {0x4000'1C00, 0x400, "TIM13"},     {0x4000'2000, 0x400, "TIM14"},
    {0x4000'2800, 0x400, "RTC"},       {0x4000'2C00, 0x400, "WWDG"},      {0x4000'3000, 0x400, "IWDG"},
    {0x4000'3400, 0x400, "I2S2ext"},   {0x4000'3800, 0x400, "SPI2"},      {0x4000'3C00, 0x400, "SPI3"},
    {0x4000'4000, 0x400, "I2S3ext"},   {0x4000'4400, 0x400, "USART2"},    {0x4000'4800, 0x400, "USART3"},
    {0x4000'4C00, 0x400, "UART4"},     {0x4000'5000, 0x400, "UART5"},     {0x4000'5400, 0x400, "I2C1"},
    {0x4000'5800, 0x400, "I2C2"},      {0x4000'5C00, 0x400, "I2C3"},      {0x4000'6400, 0x400, "CAN1"},
    {0x4000'6800, 0x400, "CAN2"},      {0x4000'7000, 0x400, "PWR"},       {0x4000'7400, 0x400, "DAC"},
    {0x4001'0000, 0x400, "TIM1"},      {0x4001'0400, 0x400, "TIM8"},      {0x4001'1000, 0x400, "USART1"},
    {0x4001'1400, 0x400, "USART6"},    {0x4001'2000, 0x400, "ADC"},       {0x4001'2C00, 0x400, "SDIO"},
    {0x4001'3000, 0x400, "SPI1"},      {0x4001'3800, 0x400, "SYSCFG"},    {0x4001'3C00, 0x400, "EXTI"},
    {0x4001'4000, 0x400, "TIM9"},      {0x4001'4400, 0x400, "TIM10"},     {0x4001'4800, 0x400, "TIM11"},
    {0x4002'0000, 0x400, "GPIOA"},     {0x4002'0400, 0x400, "GPIOB"},     {0x4002'0800, 0x400, "GPIOC"},
    {0x4002'0C00, 0x400, "GPIOD"},     {0x4002'1000, 0x400, "GPIOE"},     {0x4002'1400, 0x400, "GPIOF"},
    {0x4002'1800, 0x400, "GPIOG"},     {0x4002'1C00, 0x400, "GPIOH"},     {0x4002'2000, 0x400, "GPIOI"},
    {0x4002'3000, 0x400, "CRC"},       {0x4002'3800, 0x400, "RCC"},       {0x4002'3C00, 0x400, "FLASH"},
    {0x4002'4000, 0x1000, "BKPSRAM"},  {0x4002'6000, 0x400, "DMA1"},      {0x4002'6400, 0x400, "DMA2"},
    {0x4004'0000, 0x4'0000, "OTG_HS"}, {0x5000'0000, 0x4'0000, "OTG_FS"}, {0x5005'0000, 0x400, "DCMI"},
    {0x5006'0800, 0x400, "RNG"},       {0xA000'0000, 0x1000, "FSMC"},     {0xE004'2000, 0x400, "DBGMCU"},
};

void put_16(std::span<std::uint8_t> bytes, std::uint32_t address, std::uint16_t value) {
  const std::uint32_t at = address - system_memory_address;
  bytes[at] = static_cast<std::uint8_t>(value);
  bytes[at + 1] = static_cast<std::uint8_t>(value >> 8U);
}

}  // namespace

std::array<std::uint8_t, system_memory_bytes> system_memory(const std::array<std::uint32_t, 3>& unique_id) {
  std::array<std::uint8_t, system_memory_bytes> bytes{};
  bytes.fill(0xFF);
  std::uint32_t address = unique_id_address;
  for (const std::uint32_t word : unique_id) {
    put_16(bytes, address, static_cast<std::uint16_t>(word));
    put_16(bytes, address + 2, static_cast<std::uint16_t>(word >> 16U));
    address += 4;
  }
  put_16(bytes, flash_kib_address, flash_kib);
  put_16(bytes, vrefin_cal_address, vrefin_cal);
  put_16(bytes, ts_cal1_address, ts_cal1);
  put_16(bytes, ts_cal2_address, ts_cal2);
  return bytes;
}

std::string describe_address(std::uint32_t address) {
  for (const Block& block : memory_map) {
    if (address - block.base < block.size) {
      return std::string(block.name) + " at offset " + hexadecimal(address - block.base);
    }
  }
  return hexadecimal(address);
}

}  // namespace proleg::sim
