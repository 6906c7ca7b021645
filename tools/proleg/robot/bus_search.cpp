#include "tools/proleg/robot/bus_search.hpp"

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <vector>

#include "host/robot/bus_connection.hpp"
#include "host/robot/bus_scan.hpp"
#include "host/transport/open_transport.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

/// Linux's ARPHRD_CAN.
constexpr int can_hardware = 280;

void add_can_interfaces(std::vector<std::string>& addresses) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator("/sys/class/net", error)) {
    int type = 0;
    std::ifstream(entry.path() / "type") >> type;
    if (type == can_hardware) {
      addresses.push_back(entry.path().filename());
    }
  }
}

/// Names that stay when adapters are plugged in in another order, where there are such names.
void add_serial_lines(std::vector<std::string>& addresses) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator("/dev/serial/by-id", error)) {
    addresses.push_back("serial:" + entry.path().string());
  }
}

std::size_t count_modules(const std::string& address) {
  boost::asio::io_context context(1);
  host::BusConnection bus([&](host::TransportListener& listener) {
    return host::open_transport(context, host::parse_bus_address(address), listener);
  });
  host::BusScan scan(bus);
  const host::BusAttachment attachment(bus, scan);
  scan.start(bus.now());
  constexpr Microseconds at_most = 3'000'000;
  bus.run_until(bus.now() + at_most, [&] { return scan.is_done() || !bus.state().is_connected; });
  const auto nodes = scan.nodes();
  return static_cast<std::size_t>(std::ranges::count_if(nodes, &host::ScannedNode::is_module)) +
         (scan.has_fresh_modules() ? 1U : 0U);
}

}  // namespace

std::vector<std::string> present_buses() {
  std::vector<std::string> addresses;
  add_can_interfaces(addresses);
  add_serial_lines(addresses);
  std::ranges::sort(addresses);
  return addresses;
}

std::string find_bus() {
  const std::vector<std::string> addresses = present_buses();
  std::vector<std::string> good;
  std::vector<std::string> reasons;
  for (const std::string& address : addresses) {
    try {
      if (count_modules(address) > 0) {
        good.push_back(address);
      } else {
        reasons.push_back(address + ": no module answers");
      }
    } catch (const std::runtime_error& error) {
      reasons.emplace_back(error.what());
    }
  }
  if (good.size() == 1) {
    return good.front();
  }
  if (good.empty()) {
    throw std::runtime_error(
        "--bus auto: found no adapter with modules behind it (" +
        (addresses.empty() ? "this computer has no CAN interface and no serial adapter" : listed(reasons)) +
        "), expected one; or name the bus with --bus");
  }
  throw std::runtime_error("--bus auto: found modules behind " + listed(good) +
                           ", expected one adapter; name the bus with --bus");
}

}  // namespace proleg::tools
