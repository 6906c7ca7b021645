#pragma once

#include "firmware/module/board_record.hpp"

namespace proleg::firmware {

/// The settings of the board, as they are in flash and as they are in force.
class BoardStore {
 public:
  explicit BoardStore(FlashPort& flash) : flash_(flash) {}

  /// Reads the flash after power-on. Without a record the settings have their default values.
  void load();
  /// Returns to the settings in flash. Settings in force that were not saved are lost.
  void reset() { in_force = stored_; }
  /// Appends a record to the flash, which stops the program for up to half a second.
  [[nodiscard]] AppendResult save(const BoardRecord& record);
  /// Appends a record with this node id; the other settings stay as they are in the flash, in any schema.
  [[nodiscard]] AppendResult save_node(std::uint8_t node);

  /// Whether the flash has_newer_schema(). save() ends it.
  [[nodiscard]] bool has_newer() const { return has_newer_; }

  /// The settings in flash, which take effect at the next reset.
  [[nodiscard]] const BoardRecord& stored() const { return stored_; }

  /// The settings in force, without the node id and the limits of over-current, which other parts have.
  BoardRecord in_force;

 private:
  FlashPort& flash_;
  BoardRecord stored_;
  bool has_newer_ = false;
};

}  // namespace proleg::firmware
