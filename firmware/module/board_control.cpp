#include "firmware/module/board_control.hpp"

namespace proleg::firmware {
namespace {

namespace object = canopen::object;
using canopen::AbortCode;
using canopen::PowerState;

static_assert(BoardRecord{}.current_limit_ma == object::current_limit.default_value);
static_assert(BoardRecord{}.current_limit_time_ms == object::current_limit_time.default_value);
static_assert(BoardRecord::max_current_ma == object::current_limit.maximum);

AbortCode save(Parts& parts, const BoardRecord& record) {
  switch (parts.board.save(record)) {
    case AppendResult::ok:
      return AbortCode::none;
    case AppendResult::invalid_record:
      return AbortCode::general_incompatibility;
    default:
      return AbortCode::hardware_error;
  }
}

/// Checks the signature, and whether parameters may be saved or restored now; CiA 301 defines the abort codes.
AbortCode check_signature(const Parts& parts, std::uint32_t found, std::uint32_t expected) {
  if (found != expected) {
    return AbortCode::refused_by_application;
  }
  return may_write_flash(parts) ? AbortCode::none : AbortCode::refused_by_state;
}

class NodeStorage final : public canopen::LssStorage {
 public:
  explicit NodeStorage(Parts& parts) : parts_(parts) {}

  [[nodiscard]] Result store_node(std::uint8_t node) override {
    if (!may_write_flash(parts_)) {
      return {canopen::lss::specific_error, canopen::lss::refused_by_state};
    }
    return {parts_.board.save_node(node) == AppendResult::ok ? canopen::lss::ok : canopen::lss::storage_failed};
  }

 private:
  Parts& parts_;
};

}  // namespace

bool may_write_flash(const Parts& parts) {
  switch (parts.drive.power().state()) {
    case PowerState::switched_on:
    case PowerState::operation_enabled:
    case PowerState::quick_stop_active:
      return false;
    default:
      return !parts.network.operational();
  }
}

AbortCode save_parameters(Parts& parts, std::uint32_t signature) {
  if (const AbortCode code = check_signature(parts, signature, canopen::signature_save); code != AbortCode::none) {
    return code;
  }
  BoardRecord record = parts.board.in_force;
  record.node = parts.board.stored().node;
  record.current_limit_ma = parts.monitor.limit_ma();
  record.current_limit_time_ms = parts.monitor.limit_time_ms();
  return save(parts, record);
}

AbortCode restore_parameters(Parts& parts, std::uint32_t signature) {
  if (const AbortCode code = check_signature(parts, signature, canopen::signature_load); code != AbortCode::none) {
    return code;
  }
  BoardRecord record;
  record.node = parts.board.stored().node;
  return save(parts, record);
}

std::optional<CanFrame> serve_lss(Parts& parts, const CanFrame& request) {
  const ModuleIdentity& identity = parts.identity;
  NodeStorage storage(parts);
  return parts.lss.serve(
      request,
      {object::vendor.default_value, identity.board_id, object::revision.default_value, serial_number(identity)},
      identity.node, storage);
}

}  // namespace proleg::firmware
