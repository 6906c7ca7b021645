#pragma once

#include "firmware/module/board_record.hpp"

namespace proleg::firmware {

/// The settings of the board: as they are in flash, and as they are in force.
class BoardStore {
 public:
  explicit BoardStore(FlashPort& flash) : flash_(flash) {}

  /// After power on: reads the flash. Without a record the settings have their default values.
  void load();
  /// What was in force and not saved is lost.
  void reset() { in_force = stored_; }
  /// Appends a record to the flash, which stops the program for up to half a second.
  [[nodiscard]] AppendResult save(const BoardRecord& record);
  /// The same for the node id, and the rest as the flash has it, in any schema.
  [[nodiscard]] AppendResult save_node(std::uint8_t node);

  /// has_newer_schema() of the flash. save() ends it.
  [[nodiscard]] bool has_newer() const { return has_newer_; }

  /// As in flash. They come into force at the next reset.
  [[nodiscard]] const BoardRecord& stored() const { return stored_; }

  /// All but the node id and the limits of over-current, which others have.
  BoardRecord in_force;

 private:
  FlashPort& flash_;
  BoardRecord stored_;
  bool has_newer_ = false;
};

}  // namespace proleg::firmware
