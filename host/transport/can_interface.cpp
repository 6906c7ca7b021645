#include "host/transport/can_interface.hpp"

#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>

#include "host/transport/descriptor.hpp"

namespace proleg::host {
namespace {

using Bytes = std::span<const std::byte>;

/// A structure of the kernel at the beginning of some bytes.
template <typename Structure>
std::optional<Structure> read(Bytes bytes) {
  if (bytes.size() < sizeof(Structure)) {
    return std::nullopt;
  }
  Structure structure;
  std::memcpy(&structure, bytes.data(), sizeof structure);
  return structure;
}

constexpr std::size_t aligned(std::size_t size) { return (size + RTA_ALIGNTO - 1) & ~std::size_t{RTA_ALIGNTO - 1}; }

void for_each_attribute(Bytes bytes, const std::function<void(unsigned type, Bytes value)>& visit) {
  while (const auto header = read<rtattr>(bytes)) {
    const std::size_t size = header->rta_len;
    if (size < sizeof(rtattr) || size > bytes.size()) {
      return;
    }
    visit(header->rta_type & static_cast<unsigned>(NLA_TYPE_MASK),
          bytes.subspan(sizeof(rtattr), size - sizeof(rtattr)));
    bytes = bytes.subspan(std::min(aligned(size), bytes.size()));
  }
}

std::optional<CanState> state_of(std::uint32_t kernel_state) {
  switch (kernel_state) {
    case CAN_STATE_ERROR_ACTIVE:
      return CanState::error_active;
    case CAN_STATE_ERROR_WARNING:
      return CanState::error_warning;
    case CAN_STATE_ERROR_PASSIVE:
      return CanState::error_passive;
    case CAN_STATE_BUS_OFF:
      return CanState::bus_off;
    default:
      return std::nullopt;
  }
}

/// The attributes that drivers of CAN controllers add.
void read_controller(CanInterface& interface, unsigned type, Bytes value) {
  const auto number = read<std::uint32_t>(value);
  if (type == IFLA_CAN_BITTIMING) {
    if (const auto timing = read<can_bittiming>(value); timing && timing->bitrate != 0) {
      interface.bit_rate = timing->bitrate;
    }
  } else if (type == IFLA_CAN_CTRLMODE) {
    const auto mode = read<can_ctrlmode>(value);
    interface.is_listen_only = mode && (mode->flags & CAN_CTRLMODE_LISTENONLY) != 0;
  } else if (type == IFLA_CAN_BERR_COUNTER) {
    if (const auto counters = read<can_berr_counter>(value)) {
      interface.transmit_errors = counters->txerr;
      interface.receive_errors = counters->rxerr;
    }
  } else if (type == IFLA_CAN_RESTART_MS) {
    interface.restart_ms = number;
  } else if (type == IFLA_CAN_STATE && number) {
    interface.state = state_of(*number);
  }
}

void read_kind(CanInterface& interface, unsigned type, Bytes value) {
  if (type == IFLA_INFO_KIND) {
    const auto* text = reinterpret_cast<const char*>(value.data());
    interface.kind.assign(text, std::find(text, text + value.size(), '\0'));
  } else if (type == IFLA_INFO_DATA) {
    for_each_attribute(value, [&](unsigned inner, Bytes data) { read_controller(interface, inner, data); });
  }
}

/// Asks the kernel for the interface with that index. Returns its answer, or nothing.
std::optional<std::size_t> ask_kernel(unsigned index, std::span<std::byte> answer) {
  struct {
    nlmsghdr header;
    ifinfomsg link;
  } request{};
  request.header.nlmsg_len = sizeof request;
  request.header.nlmsg_type = RTM_GETLINK;
  request.header.nlmsg_flags = NLM_F_REQUEST;
  request.link.ifi_family = AF_UNSPEC;
  request.link.ifi_index = static_cast<int>(index);
  const Descriptor socket(::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE));
  // The kernel answers before send() returns, so that a wait is not needed.
  if (!socket.is_open() || ::send(socket.number(), &request, sizeof request, 0) != sizeof request) {
    return std::nullopt;
  }
  const ssize_t size = ::recv(socket.number(), answer.data(), answer.size(), MSG_DONTWAIT);
  return size > 0 ? std::optional(static_cast<std::size_t>(size)) : std::nullopt;
}

}  // namespace

std::optional<CanInterface> parse_link_message(std::span<const std::byte> message) {
  const auto header = read<nlmsghdr>(message);
  if (!header || header->nlmsg_type != RTM_NEWLINK || header->nlmsg_len > message.size() ||
      header->nlmsg_len < sizeof(nlmsghdr) + sizeof(ifinfomsg)) {
    return std::nullopt;
  }
  const Bytes body = message.subspan(sizeof(nlmsghdr), header->nlmsg_len - sizeof(nlmsghdr));
  const auto link = read<ifinfomsg>(body);
  CanInterface interface;
  interface.is_can = link->ifi_type == ARPHRD_CAN;
  interface.is_up = (link->ifi_flags & IFF_UP) != 0;
  for_each_attribute(body.subspan(sizeof(ifinfomsg)), [&](unsigned type, Bytes value) {
    if (type == IFLA_TXQLEN) {
      interface.queue_length = read<std::uint32_t>(value);
    } else if (type == IFLA_LINKINFO) {
      for_each_attribute(value, [&](unsigned inner, Bytes data) { read_kind(interface, inner, data); });
    }
  });
  if (!interface.is_up) {
    interface.state.reset();
  }
  return interface;
}

std::optional<CanInterface> read_can_interface(const std::string& name) {
  const unsigned index = if_nametoindex(name.c_str());
  if (index == 0) {
    return std::nullopt;
  }
  constexpr std::size_t longest_answer = 32'768;
  std::array<std::byte, longest_answer> answer{};
  const auto size = ask_kernel(index, answer);
  return size ? parse_link_message(std::span(answer).first(*size)) : std::nullopt;
}

}  // namespace proleg::host
