#pragma once

#include <array>
#include <cstdint>

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

}  // namespace proleg::sim
