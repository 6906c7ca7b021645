#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace proleg::sim {

/// The filter banks of bxCAN (RM0090, 32.7.4 and 32.9.4): which frames a controller accepts, and into which FIFO.
/// Frames have 11-bit identifiers: the filter bits for IDE, RTR and the extended identifier are compared with zeros.
class BxCanFilters {
 public:
  static constexpr unsigned bank_count = 28;

  struct Match {
    unsigned fifo;   ///< 0 or 1
    unsigned index;  ///< filter match index: RDTxR.FMI

    friend bool operator==(const Match&, const Match&) = default;
  };

  [[nodiscard]] static bool contains(std::uint32_t offset);
  /// Name of a register: "F13R2".
  [[nodiscard]] static std::string register_name(std::uint32_t offset);
  /// Value of a register, which must exist.
  [[nodiscard]] std::uint32_t read(std::uint32_t offset) const;
  /// Writes a register. Returns the reason if the write is rejected; then no register has changed.
  [[nodiscard]] std::optional<std::string> write(std::uint32_t offset, std::uint32_t value);
  void reset() { *this = BxCanFilters(); }

  /// The filter that a frame passes; nothing if no active filter accepts it, or while FINIT is set. Only banks below
  /// CAN2SB count: the others belong to CAN2.
  [[nodiscard]] std::optional<Match> match(std::uint16_t identifier) const;

 private:
  [[nodiscard]] bool is_initialising() const { return (master_ & 1U) != 0; }
  [[nodiscard]] unsigned first_bank_of_can2() const { return (master_ >> 8U) & 0x3FU; }
  [[nodiscard]] const std::uint32_t* configuration(std::uint32_t offset) const;

  std::uint32_t master_ = 0x2A1C'0E01;
  std::uint32_t list_mode_ = 0;   ///< FM1R: 1 for identifier list, 0 for mask
  std::uint32_t wide_ = 0;        ///< FS1R: 1 for 32 bits, 0 for 16
  std::uint32_t assignment_ = 0;  ///< FFA1R: the FIFO of each bank
  std::uint32_t active_ = 0;      ///< FA1R: the banks in use
  std::array<std::array<std::uint32_t, 2>, bank_count> banks_{};
};

}  // namespace proleg::sim
