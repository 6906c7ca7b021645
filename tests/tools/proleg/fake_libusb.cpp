// libusb with one device, for dfu-util: the ROM bootloader of an STM32F405, whose control transfers another program
// answers. It is loaded before the real library (LD_PRELOAD). PROLEG_FAKE_DFU names the socket of that program; without
// it there is no device.
//
// A transfer on the socket: the setup packet (8 bytes), and the data if they go to the device. The answer: i32, the
// number of bytes or an error of libusb, and the data if they come from the device.
//
// With PROLEG_PATIENT_LINE reads of a serial line wait 25 s for a byte instead of the half second of stm32flash: the
// program at the other end may wait for a processor.

#include <dlfcn.h>
#include <libusb.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

struct libusb_device {};
struct libusb_device_handle {
  int socket = -1;
};

namespace {

constexpr std::uint16_t st = 0x0483;
constexpr std::uint16_t dfu = 0xDF11;
constexpr std::uint8_t alternates = 4;  // flash, option bytes, one-time programmable memory, device feature
constexpr std::uint8_t first_name = 4;  // number of the string that describes the first of them

libusb_device the_device;
libusb_device_handle the_handle;

// DFU 1.1, section 4.1.3, with the version of DfuSe (AN3156): 2048 bytes a transfer.
constexpr std::array<std::uint8_t, 9> dfu_descriptor{9, 0x21, 0x0B, 0xFF, 0, 0, 0x08, 0x1A, 0x01};

struct Configuration {
  libusb_config_descriptor configuration{};
  libusb_interface interface {};
  std::array<libusb_interface_descriptor, alternates> settings{};

  Configuration() {
    for (std::uint8_t i = 0; i < alternates; ++i) {
      libusb_interface_descriptor& setting = settings.at(i);
      setting.bAlternateSetting = i;
      setting.bInterfaceClass = 0xFE;
      setting.bInterfaceSubClass = 1;
      setting.bInterfaceProtocol = 2;
      setting.iInterface = static_cast<std::uint8_t>(first_name + i);
      setting.extra = dfu_descriptor.data();
      setting.extra_length = static_cast<int>(dfu_descriptor.size());
    }
    interface.altsetting = settings.data();
    interface.num_altsetting = alternates;
    configuration.bNumInterfaces = 1;
    configuration.bConfigurationValue = 1;
    configuration.interface = &interface;
  }
};

Configuration the_configuration;

bool transfer_all(int socket, std::uint8_t* bytes, std::size_t size, bool is_sent) {
  while (size > 0) {
    const ssize_t done = is_sent ? send(socket, bytes, size, MSG_NOSIGNAL) : recv(socket, bytes, size, 0);
    if (done <= 0) {
      return false;
    }
    bytes += done;
    size -= static_cast<std::size_t>(done);
  }
  return true;
}

}  // namespace

extern "C" {

int libusb_init(libusb_context** context) {
  *context = nullptr;
  return 0;
}
void libusb_exit(libusb_context*) {}
int libusb_set_option(libusb_context*, libusb_option, ...) { return 0; }

ssize_t libusb_get_device_list(libusb_context*, libusb_device*** list) {
  const bool is_there = std::getenv("PROLEG_FAKE_DFU") != nullptr;
  *list = new libusb_device* [2] { is_there ? &the_device : nullptr, nullptr };
  return is_there ? 1 : 0;
}
void libusb_free_device_list(libusb_device** list, int) { delete[] list; }
libusb_device* libusb_ref_device(libusb_device* device) { return device; }
void libusb_unref_device(libusb_device*) {}
std::uint8_t libusb_get_bus_number(libusb_device*) { return 1; }
std::uint8_t libusb_get_device_address(libusb_device*) { return 1; }
int libusb_get_port_numbers(libusb_device*, std::uint8_t* ports, int) {
  *ports = 1;
  return 1;
}

int libusb_get_device_descriptor(libusb_device*, libusb_device_descriptor* descriptor) {
  *descriptor = {};
  descriptor->idVendor = st;
  descriptor->idProduct = dfu;
  descriptor->bcdDevice = 0x2200;
  descriptor->bMaxPacketSize0 = 64;
  descriptor->bNumConfigurations = 1;
  return 0;
}
int libusb_get_config_descriptor(libusb_device*, std::uint8_t, libusb_config_descriptor** configuration) {
  *configuration = &the_configuration.configuration;
  return 0;
}
void libusb_free_config_descriptor(libusb_config_descriptor*) {}

int libusb_open(libusb_device*, libusb_device_handle** handle) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, std::getenv("PROLEG_FAKE_DFU"), sizeof(address.sun_path) - 1);
  the_handle.socket = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (connect(the_handle.socket, reinterpret_cast<sockaddr*>(&address), sizeof(address)) != 0) {
    return LIBUSB_ERROR_ACCESS;
  }
  *handle = &the_handle;
  return 0;
}
void libusb_close(libusb_device_handle* handle) { close(handle->socket); }
int libusb_claim_interface(libusb_device_handle*, int) { return 0; }
int libusb_release_interface(libusb_device_handle*, int) { return 0; }
int libusb_reset_device(libusb_device_handle*) { return 0; }

int libusb_control_transfer(libusb_device_handle* handle, std::uint8_t type, std::uint8_t request, std::uint16_t value,
                            std::uint16_t index, unsigned char* data, std::uint16_t length, unsigned) {
  std::vector<std::uint8_t> bytes{type, request};
  for (const std::uint16_t word : {value, index, length}) {
    bytes.push_back(static_cast<std::uint8_t>(word & 0xFFU));
    bytes.push_back(static_cast<std::uint8_t>(word >> 8U));
  }
  const bool is_input = (type & LIBUSB_ENDPOINT_IN) != 0;
  if (!is_input && length > 0) {
    bytes.insert(bytes.end(), data, data + length);
  }
  std::array<std::uint8_t, 4> answer{};
  if (!transfer_all(handle->socket, bytes.data(), bytes.size(), true) ||
      !transfer_all(handle->socket, answer.data(), answer.size(), false)) {
    return LIBUSB_ERROR_NO_DEVICE;
  }
  std::int32_t result = 0;
  std::memcpy(&result, answer.data(), sizeof(result));
  if (is_input && result > 0 &&
      !transfer_all(handle->socket, data, std::min<std::size_t>(static_cast<std::size_t>(result), length), false)) {
    return LIBUSB_ERROR_NO_DEVICE;
  }
  return result;
}
int libusb_set_interface_alt_setting(libusb_device_handle* handle, int interface, int setting) {
  return libusb_control_transfer(handle, LIBUSB_RECIPIENT_INTERFACE, LIBUSB_REQUEST_SET_INTERFACE,
                                 static_cast<std::uint16_t>(setting), static_cast<std::uint16_t>(interface), nullptr, 0,
                                 0);
}

int tcsetattr(int line, int when, const termios* settings) noexcept {
  constexpr cc_t longest_wait = 255;  // tenths of a second
  termios patient = *settings;
  if (std::getenv("PROLEG_PATIENT_LINE") != nullptr && patient.c_cc[VMIN] == 0 && patient.c_cc[VTIME] != 0) {
    patient.c_cc[VTIME] = longest_wait;
  }
  return reinterpret_cast<decltype(&tcsetattr)>(dlsym(RTLD_NEXT, "tcsetattr"))(line, when, &patient);
}

}  // extern "C"
