#include "shared/canopen/lss_slave.hpp"

namespace proleg::canopen {
namespace {

using lss::Service;

/// Position of a service in a range of services that begins with `first`.
constexpr unsigned position_in(Service first, Service service) {
  return static_cast<unsigned>(service) - static_cast<unsigned>(first);
}

CanFrame answer(Service service, std::uint8_t first = 0, std::uint8_t second = 0) {
  return lss::make(identifier::lss_answer, service, first, second);
}

}  // namespace

void LssSlave::reset() {
  state_ = lss::State::waiting;
  selected_ = 0;
  identified_ = 0;
  scanned_ = 0;
}

std::optional<CanFrame> LssSlave::serve(const CanFrame& request, const LssAddress& address, std::uint8_t node,
                                        LssStorage& storage) {
  if (request.identifier != identifier::lss_request || request.length != 8) {
    return std::nullopt;
  }
  const Service service = lss::service_of(request);
  const bool is_configured = node != 0 || pending_node_ != 0;
  switch (service) {
    case Service::switch_state_global:
      if (request.data[1] <= static_cast<std::uint8_t>(lss::State::configuration)) {
        state_ = static_cast<lss::State>(request.data[1]);
        selected_ = 0;
      }
      return std::nullopt;
    case Service::identify_non_configured:
      return is_configured ? std::nullopt : std::optional(answer(Service::identified_non_configured));
    case Service::fastscan:
      return !is_configured && state_ == lss::State::waiting && scan(lss::fastscan_of(request), address)
                 ? std::optional(answer(Service::identified))
                 : std::nullopt;
    default:
      break;
  }
  if (service >= Service::select_vendor && service <= Service::select_serial) {
    return select(position_in(Service::select_vendor, service), lss::word_of(request), address)
               ? std::optional(answer(Service::selected))
               : std::nullopt;
  }
  if (service >= Service::identify_vendor && service <= Service::identify_serial_high) {
    return identify(position_in(Service::identify_vendor, service), lss::word_of(request), address)
               ? std::optional(answer(Service::identified))
               : std::nullopt;
  }
  return state_ == lss::State::configuration ? configure(request, address, node, storage) : std::nullopt;
}

/// Handles a service of a slave that is selected.
std::optional<CanFrame> LssSlave::configure(const CanFrame& request, const LssAddress& address, std::uint8_t node,
                                            LssStorage& storage) {
  const Service service = lss::service_of(request);
  switch (service) {
    case Service::configure_node_id:
      return answer(service, set_node(request.data[1]));
    case Service::configure_bit_timing: {
      const bool is_supported = request.data[1] == lss::standard_table && request.data[2] == lss::timing_1_mbit;
      return answer(service, is_supported ? lss::ok : lss::not_supported);
    }
    case Service::store_configuration: {
      const LssStorage::Result result = storage.store_node(pending_node_);
      return answer(service, result.error, result.specific);
    }
    case Service::inquire_node_id:
      return answer(service, node == 0 ? lss::no_node_id : node);
    default:
      break;
  }
  if (service >= Service::inquire_vendor && service <= Service::inquire_serial) {
    return lss::make_word(identifier::lss_answer, service, address[position_in(Service::inquire_vendor, service)]);
  }
  // activate_bit_timing has no answer; the only bit timing is in use already.
  return std::nullopt;
}

/// Handles a request that selects a number of the address. Returns whether all four numbers were selected in order.
bool LssSlave::select(unsigned position, std::uint32_t number, const LssAddress& address) {
  if (state_ != lss::State::waiting) {
    return false;
  }
  selected_ = position == 0 ? std::uint8_t{0} : selected_;
  if (position != selected_ || number != address[position]) {
    selected_ = 0;
    return false;
  }
  if (++selected_ < address.size()) {
    return false;
  }
  selected_ = 0;
  state_ = lss::State::configuration;
  return true;
}

/// Handles a condition. Returns whether all six hold: vendor and product are equal, revision and serial number are
/// within their limits. They come in this order: vendor, product, lowest and highest revision, lowest and highest
/// serial number.
bool LssSlave::identify(unsigned position, std::uint32_t number, const LssAddress& address) {
  identified_ = position == 0 ? std::uint8_t{0} : identified_;
  constexpr unsigned first_limit = 2;
  constexpr unsigned conditions = 6;
  bool holds = position == identified_;
  if (position < first_limit) {
    holds = holds && number == address[position];
  } else {
    const std::uint32_t own = address[first_limit + (position - first_limit) / 2];
    holds = holds && (position % 2 == 0 ? number <= own : own <= number);
  }
  if (!holds) {
    identified_ = conditions;  // until the first condition comes again
    return false;
  }
  ++identified_;
  return identified_ == conditions;
}

bool LssSlave::scan(const lss::FastscanRequest& request, const LssAddress& address) {
  constexpr std::uint8_t last_bit = 31;
  if (request.bit == lss::fastscan_start) {
    scanned_ = 0;
    return true;
  }
  if (request.bit > last_bit || request.sub != scanned_ || request.next >= address.size() ||
      ((request.number ^ address[request.sub]) >> request.bit) != 0) {
    return false;
  }
  if (request.bit == 0) {
    scanned_ = request.next;
    state_ = request.next < request.sub ? lss::State::configuration : lss::State::waiting;
  }
  return true;
}

std::uint8_t LssSlave::set_node(std::uint8_t node) {
  if (node != lss::no_node_id && (node < min_node_id || node > max_node_id)) {
    return lss::not_supported;
  }
  pending_node_ = node == lss::no_node_id ? std::uint8_t{0} : node;
  return lss::ok;
}

}  // namespace proleg::canopen
