#include "host/transport/open_transport.hpp"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <filesystem>

#include "shared/computer/algorithm_library/algorithm_library.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::host {
namespace {

std::string other_folder;  ///< of use_programs_of()

class DescriptorLink final : public Link {
 public:
  explicit DescriptorLink(int descriptor) : descriptor_(descriptor) {}

  [[nodiscard]] Opened open() override {
    if (!make_private(descriptor_)) {
      const int error = errno;
      static_cast<void>(descriptor_.release());
      throw TransportError(std::string(system_text(error)) + ": this process has not inherited such a descriptor");
    }
    return {std::move(descriptor_), false};
  }
  [[nodiscard]] std::string silence_hint() const override { return "is there an slcan adapter at its other end?"; }
  [[nodiscard]] bool can_reopen() const override { return false; }

 private:
  Descriptor descriptor_;
};

/// The simulated modules have the algorithms that this program has.
std::vector<std::string> arguments_of_bus(const std::string& file) {
  std::vector<std::string> arguments{file};
  for (const std::string& library : loaded_libraries()) {
    arguments.insert(arguments.end(), {"--algorithms", library});
  }
  return arguments;
}

std::unique_ptr<Link> make_link(const BusAddress& address) {
  switch (address.kind) {
    case BusAddress::Kind::serial:
      return make_serial_link(address.name, address.number);
    case BusAddress::Kind::bluetooth:
      return make_bluetooth_link(address);
    case BusAddress::Kind::tcp:
      return make_tcp_link(address.name, address.number);
    case BusAddress::Kind::descriptor:
      return make_descriptor_link(static_cast<int>(address.number));
    case BusAddress::Kind::simulation:
      // The program reports a missing file too, but as a second line, after the line about the lost connection.
      if (!std::filesystem::is_regular_file(address.name)) {
        throw InputError("--bus", 0, in_quotes(bus_address_text(address)), "sim:FILE with a scenario that is there");
      }
      return make_program_link(program_folder() + "proleg-bus", arguments_of_bus(address.name));
    case BusAddress::Kind::can:
    case BusAddress::Kind::automatic:
      break;
  }
  throw TransportError(bus_address_text(address) + ": name the bus: " + bus_address_syntax());
}

}  // namespace

std::string Link::connect_failure(int error) const { return system_text(error); }

std::string Link::end_text(int error) {
  return error == 0 || error == EPIPE || error == ECONNRESET
             ? "the other end has closed the connection"
             : std::string("the connection has ended: ") + system_text(error);
}

std::unique_ptr<Link> make_descriptor_link(int descriptor) { return std::make_unique<DescriptorLink>(descriptor); }

void use_programs_of(const std::string& folder) { other_folder = folder + "/"; }

std::string program_folder() {
  if (!other_folder.empty()) {
    return other_folder;
  }
  std::array<char, 4'096> path{};
  const ssize_t length = readlink("/proc/self/exe", path.data(), path.size());
  const std::string program(path.data(), length > 0 ? static_cast<std::size_t>(length) : 0U);
  return program.substr(0, program.rfind('/') + 1);
}

std::unique_ptr<Transport> open_transport(boost::asio::io_context& context, const BusAddress& address,
                                          TransportListener& listener) {
  if (address.kind == BusAddress::Kind::can) {
    return open_can_transport(context, address.name, listener);
  }
  return open_slcan_transport(context, bus_address_text(address), make_link(address), listener);
}

}  // namespace proleg::host
