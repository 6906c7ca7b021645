#include "host/transport/can_socket.hpp"

#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <vector>

#include "host/transport/event_loop.hpp"
#include "host/transport/transport.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::host {
namespace {

// Positions of bytes in the data of an error frame.
constexpr std::size_t controller_byte = 1;
constexpr std::size_t violation_byte = 2;
constexpr std::size_t location_byte = 3;
constexpr std::size_t transmit_counter = 6;
constexpr std::size_t receive_counter = 7;
constexpr canid_t has_counters = 0x200;        // CAN_ERR_CNT of Linux 5.18 and later
constexpr unsigned controller_active = 0x40;   // CAN_ERR_CRTL_ACTIVE
constexpr std::uint16_t bus_off_errors = 256;  // number of errors at bus-off; in the frame the counter is one byte

std::optional<CanState> state_of(const can_frame& frame) {
  const unsigned controller = (frame.can_id & CAN_ERR_CRTL) != 0 ? frame.data[controller_byte] : 0U;
  if ((frame.can_id & CAN_ERR_BUSOFF) != 0) {
    return CanState::bus_off;
  }
  if ((controller & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0) {
    return CanState::error_passive;
  }
  if ((controller & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) != 0) {
    return CanState::error_warning;
  }
  if ((frame.can_id & CAN_ERR_RESTARTED) != 0 || (controller & controller_active) != 0) {
    return CanState::error_active;
  }
  return std::nullopt;
}

CanErrors errors_of(const can_frame& frame) {
  CanErrors errors;
  const auto add_if = [&errors](bool holds, CanErrorKind kind) {
    if (holds) {
      errors.add(kind);
    }
  };
  const bool has_protocol = (frame.can_id & CAN_ERR_PROT) != 0;
  const unsigned violation = has_protocol ? frame.data[violation_byte] : 0U;
  const unsigned location = has_protocol ? frame.data[location_byte] : 0U;
  const unsigned controller = (frame.can_id & CAN_ERR_CRTL) != 0 ? frame.data[controller_byte] : 0U;
  add_if((frame.can_id & CAN_ERR_ACK) != 0 || location == CAN_ERR_PROT_LOC_ACK, CanErrorKind::acknowledgement);
  add_if((violation & CAN_ERR_PROT_BIT0) != 0, CanErrorKind::bit_dominant);
  add_if((violation & CAN_ERR_PROT_BIT1) != 0, CanErrorKind::bit_recessive);
  add_if(location == CAN_ERR_PROT_LOC_CRC_SEQ || location == CAN_ERR_PROT_LOC_CRC_DEL, CanErrorKind::crc);
  add_if((violation & CAN_ERR_PROT_FORM) != 0, CanErrorKind::form);
  add_if((violation & CAN_ERR_PROT_STUFF) != 0, CanErrorKind::stuff);
  add_if((controller & CAN_ERR_CRTL_RX_OVERFLOW) != 0, CanErrorKind::receive_overrun);
  add_if((controller & CAN_ERR_CRTL_TX_OVERFLOW) != 0, CanErrorKind::transmit_overrun);
  return errors;
}

constexpr int receive_buffer = 1'000'000;  // bytes; the kernel may give less
constexpr Microseconds microseconds_per_second = 1'000'000;

/// The CAN interfaces of this computer, for an error.
std::string present_interfaces() {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/sys/class/net", ignored)) {
    int type = 0;
    if (std::ifstream(entry.path() / "type") >> type && type == ARPHRD_CAN) {
      names.push_back(entry.path().filename().string());
    }
  }
  std::sort(names.begin(), names.end());
  return names.empty() ? "this computer has no CAN interface" : "there is " + listed(names);
}

/// Makes the argument of a request of netdevice(7).
ifreq request_for(const std::string& interface) {
  ifreq request{};
  std::copy_n(interface.begin(), std::min<std::size_t>(interface.size(), IFNAMSIZ - 1), request.ifr_name);
  return request;
}

/// The index of an interface that can be used. Throws TransportError.
int index_of(const Descriptor& socket, const std::string& interface) {
  ifreq request = request_for(interface);
  if (ioctl(socket.number(), SIOCGIFINDEX, &request) != 0) {
    throw TransportError("no such interface; " + present_interfaces() +
                             ". A virtual one: sudo modprobe vcan; sudo ip link add dev " + interface +
                             " type vcan; sudo ip link set " + interface + " up",
                         TransportProblem::missing);
  }
  const int index = request.ifr_ifindex;
  request = request_for(interface);
  if (ioctl(socket.number(), SIOCGIFHWADDR, &request) == 0 && request.ifr_hwaddr.sa_family != ARPHRD_CAN) {
    throw TransportError("it is no CAN interface; " + present_interfaces(), TransportProblem::wrong_kind);
  }
  request = request_for(interface);
  if (ioctl(socket.number(), SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) == 0) {
    throw TransportError(can_failure(interface, ENETDOWN), TransportProblem::interface_down);
  }
  return index;
}

/// The time of the kernel's stamp on the steady clock.
Microseconds steady_time_of(const timeval& stamp) {
  const auto since_epoch =
      std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch());
  const auto time =
      static_cast<Microseconds>(stamp.tv_sec) * microseconds_per_second + static_cast<Microseconds>(stamp.tv_usec);
  const auto system_time = static_cast<Microseconds>(since_epoch.count());
  const Microseconds now = steady_now();
  // The system's clock may have been set since the stamp; the frame is not older than a second then, and not newer
  // than now.
  const Microseconds age = system_time > time ? std::min(system_time - time, microseconds_per_second) : 0;
  return now - std::min(age, now);
}

}  // namespace

CanErrorReport read_can_error(const can_frame& frame, const CanStatus& before) {
  CanErrorReport report{before, errors_of(frame), (frame.can_id & CAN_ERR_RESTARTED) != 0};
  const std::optional<CanState> state = state_of(frame);
  report.status.state = state.value_or(before.state);
  const bool is_off = report.status.state == CanState::bus_off;
  if ((frame.can_id & has_counters) != 0 && !is_off) {
    report.status.transmit_errors = frame.data[transmit_counter];
    report.status.receive_errors = frame.data[receive_counter];
  } else if (state == CanState::bus_off) {
    report.status.transmit_errors = bus_off_errors;
  } else if (state == CanState::error_active) {
    report.status.transmit_errors = 0;
    report.status.receive_errors = 0;
  }
  return report;
}

CanSocket::CanSocket(const std::string& interface, const Options& options)
    : socket_(::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW)) {
  if (!socket_.is_open()) {
    const int error = errno;
    const bool has_no_can = error == EAFNOSUPPORT || error == EPROTONOSUPPORT;
    throw TransportError(std::string(system_text(error)) +
                             (has_no_can ? ": the kernel has no CAN (sudo modprobe can-raw)" : ": no CAN socket"),
                         has_no_can ? TransportProblem::no_kernel_support : TransportProblem::other);
  }
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = index_of(socket_, interface);
  set_options(options);
  if (bind(socket_.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    throw TransportError(can_failure(interface, errno));
  }
}

void CanSocket::set_options(const Options& options) const {
  const can_err_mask_t errors = options.has_error_frames ? CAN_ERR_MASK : 0U;
  const int own = options.receives_own_frames ? 1 : 0;
  const int on = 1;
  // A kernel without one of these still carries frames.
  setsockopt(socket_.number(), SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors);
  setsockopt(socket_.number(), SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, &own, sizeof own);
  setsockopt(socket_.number(), SOL_SOCKET, SO_TIMESTAMP, &on, sizeof on);
  setsockopt(socket_.number(), SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);
  setsockopt(socket_.number(), SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
}

std::optional<CanSocket::Received> CanSocket::read() {
  Received received;
  iovec part{&received.frame, sizeof received.frame};
  alignas(cmsghdr) std::array<char, 256> control{};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t size = recvmsg(socket_.number(), &message, 0);
  if (size < 0) {
    error_ = errno == EAGAIN || errno == EINTR ? 0 : errno;
    return std::nullopt;
  }
  if (static_cast<std::size_t>(size) != sizeof received.frame) {
    error_ = 0;
    return std::nullopt;  // no such frame can come, since CAN FD is not enabled
  }
  received.is_own = (static_cast<unsigned>(message.msg_flags) & MSG_CONFIRM) != 0;
  received.time = steady_now();
  for (cmsghdr* header = CMSG_FIRSTHDR(&message); header != nullptr; header = CMSG_NXTHDR(&message, header)) {
    if (header->cmsg_level != SOL_SOCKET) {
      continue;
    }
    if (header->cmsg_type == SO_TIMESTAMP) {
      timeval stamp{};
      std::memcpy(&stamp, CMSG_DATA(header), sizeof stamp);
      received.time = steady_time_of(stamp);
    } else if (header->cmsg_type == SO_RXQ_OVFL) {
      std::memcpy(&dropped_, CMSG_DATA(header), sizeof dropped_);
    }
  }
  return received;
}

int CanSocket::write(const CanFrame& frame) {
  can_frame raw{};
  raw.can_id = frame.identifier;
  raw.can_dlc = frame.length;
  std::copy(frame.data.begin(), frame.data.end(), raw.data);
  const ssize_t size = ::send(socket_.number(), &raw, sizeof raw, MSG_NOSIGNAL);
  return size < 0 ? errno : 0;
}

std::optional<CanFrame> protocol_frame(const can_frame& frame) {
  if ((frame.can_id & (CAN_EFF_FLAG | CAN_RTR_FLAG | CAN_ERR_FLAG)) != 0 || frame.can_dlc > CanFrame::max_length) {
    return std::nullopt;
  }
  CanFrame result{static_cast<std::uint16_t>(frame.can_id & CAN_SFF_MASK), frame.can_dlc, {}};
  std::copy_n(frame.data, frame.can_dlc, result.data.begin());
  return result;
}

std::string can_failure(const std::string& interface, int error) {
  switch (error) {
    case ENETDOWN:
      return "the interface is down: sudo ip link set " + interface +
             " up type can bitrate 1000000 (a virtual one: sudo ip link set " + interface + " up)";
    case ENODEV:
    case ENXIO:
      return "the interface is gone (was the adapter unplugged?)";
    default:
      return system_text(error);
  }
}

}  // namespace proleg::host
