#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "shared/can/can_frame.hpp"

namespace proleg::sim {

/// A receive FIFO of bxCAN, three frames deep (RM0090, 32.7.3 and 32.9.2: RFxR, RIxR to RDHxR).
class BxCanFifo {
 public:
  /// Register RFxR.
  [[nodiscard]] std::uint32_t status() const;
  void write_status(std::uint32_t value);
  /// RIxR, RDTxR, RDLxR, RDHxR as words 0 to 3, of the oldest frame; if the FIFO is empty, of the last frame it had.
  [[nodiscard]] std::uint32_t read(std::uint32_t word) const;

  /// Stores a frame. A full FIFO loses this frame if it is locked (MCR.RFLM), else the frame before it.
  void store(const CanFrame& frame, unsigned filter_match_index, bool locked);

  [[nodiscard]] bool is_pending() const { return count_ > 0; }
  [[nodiscard]] bool is_full() const { return full_; }
  [[nodiscard]] bool is_overrun() const { return overrun_; }

 private:
  struct Stored {
    CanFrame frame;
    unsigned filter_match_index = 0;
  };
  static constexpr unsigned depth = 3;

  std::array<Stored, depth> stored_{};
  unsigned first_ = 0;
  unsigned count_ = 0;
  bool full_ = false;     ///< FULL, which the program clears
  bool overrun_ = false;  ///< flag FOVR
};

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
