#include "tools/proleg/robot/bus_access.hpp"

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <vector>

#include "host/robot/bus_connection.hpp"
#include "host/robot/bus_scan.hpp"
#include "host/robot/host_presence.hpp"
#include "host/robot/object_word.hpp"
#include "host/transport/open_transport.hpp"
#include "shared/canopen/messages.hpp"
#include "shared/computer/master/master.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/command_line.hpp"

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

std::string BusOptions::address() const {
  const char* environment = std::getenv("PROLEG_BUS");
  return bus.value_or(environment != nullptr && *environment != '\0' ? environment : "auto");
}

bool can_have_real_servos(const std::string& address) {
  return host::parse_bus_address(address).kind != host::BusAddress::Kind::simulation;
}

void add_bus_option(CommandLine& command_line, BusOptions& options) {
  command_line
      .add_option("--bus", options.bus,
                  "where the robot is: " + host::bus_address_syntax() + ". Without it: $PROLEG_BUS, else auto")
      .value_name("BUS");
}

class BusAccess::Implementation {
 public:
  explicit Implementation(const host::BusAddress& address)
      : connection_(
            [&](host::TransportListener& listener) { return host::open_transport(context_, address, listener); }) {}
  explicit Implementation(const host::BusConnection::Open& open) : connection_(open) {}

  [[nodiscard]] host::BusConnection& connection() { return connection_; }
  [[nodiscard]] boost::asio::io_context& context() { return context_; }

 private:
  boost::asio::io_context context_{1};
  host::BusConnection connection_;
};

BusAccess::BusAccess(const BusOptions& options)
    : implementation_(std::make_unique<Implementation>(
          host::parse_bus_address(options.address() == "auto" ? find_bus() : options.address()))) {}
BusAccess::BusAccess(const host::BusConnection::Open& open) : implementation_(std::make_unique<Implementation>(open)) {}
BusAccess::~BusAccess() = default;

host::BusConnection& BusAccess::connection() { return implementation_->connection(); }
boost::asio::io_context& BusAccess::context() { return implementation_->context(); }

void BusAccess::wait_for(const std::string& what, Microseconds at_most, const std::function<bool()>& done) {
  host::BusConnection& bus = connection();
  bool is_done = false;
  bus.run_until(bus.now() + at_most, [&] {
    is_done = done();
    return is_done || interrupted() || !bus.state().is_connected;
  });
  if (is_done) {
    return;
  }
  if (interrupted()) {
    throw std::runtime_error("interrupted while waiting for " + what);
  }
  if (!bus.state().is_connected) {
    throw std::runtime_error(bus.diagnosis());
  }
  throw std::runtime_error(what + ": found none in " + std::to_string(at_most / 1'000'000) + " s; " + bus.diagnosis());
}

void require_no_host(BusAccess& bus) {
  host::BusConnection& connection = bus.connection();
  host::HostPresence host(connection.now());
  const host::BusAttachment attachment(connection, host);
  while (!host.is_there() && connection.now() < host.silent_at()) {
    connection.run_until(host.silent_at(), [&host] { return host.is_there(); });
  }
  if (host.is_there()) {
    throw std::runtime_error("another host drives the robot; nothing was sent. End that program first");
  }
}

void scan(BusAccess& bus, host::BusScan& scan) {
  constexpr Microseconds longest = 60'000'000;
  const host::BusAttachment attachment(bus.connection(), scan);
  scan.start(bus.connection().now());
  bus.wait_for("the end of the scan", longest, [&scan] { return scan.is_done(); });
}

canopen::SdoTransferOptions patient_transfers() {
  canopen::SdoTransferOptions options;
  options.timeout_us = host::patient_timeout_us;
  options.attempts = host::patient_attempts;
  return options;
}

std::vector<std::uint8_t> nodes_of(BusAccess& bus, const std::string& word) {
  if (const auto nodes = host::parse_nodes(word)) {
    return *nodes;
  }
  host::BusScan all(bus.connection());
  scan(bus, all);
  std::vector<std::uint8_t> nodes;
  for (const host::ScannedNode& node : all.nodes()) {
    if (node.is_module) {
      nodes.push_back(node.node);
    }
  }
  if (nodes.empty()) {
    throw std::runtime_error("found no joint module on the bus; " + bus.connection().diagnosis());
  }
  return nodes;
}

void finish(BusAccess& bus, host::SdoQueue& queue) {
  constexpr Microseconds longest = 120'000'000;
  const host::BusAttachment attachment(bus.connection(), queue);
  bus.wait_for("the answers of the modules", longest, [&queue] { return queue.is_idle(); });
}

std::string failure_text(std::uint8_t node, const std::string& object, canopen::AbortCode code,
                         const std::string& cause) {
  const std::string name = "node " + std::to_string(node);
  if (code == canopen::AbortCode::timeout) {
    return name + ": no answer to a request for " + object + "; " + cause;
  }
  return name + ": " + object + ": " + std::string(canopen::describe(code));
}

void HostPresence::poll(Microseconds now) {
  constexpr Microseconds period_us = canopen::Master::heartbeat_period_us;
  constexpr Microseconds until_next_try_us = 1'000;
  if (is_active_ && now >= next_) {
    const bool is_sent =
        bus_.send(canopen::encode(canopen::Heartbeat{canopen::host_node, canopen::NmtState::operational}));
    next_ = now + (is_sent ? period_us : until_next_try_us);
  }
}

canopen::Object AlgorithmTable::object(std::uint8_t node, const host::ObjectWord& word) const {
  const auto found = ids_.find(node);
  return word.object(word.slot() && found != ids_.end() ? found->second.at(*word.slot()) : std::uint8_t{0});
}

AlgorithmTable read_algorithms(BusAccess& bus, host::SdoQueue& queue, std::span<const std::uint8_t> nodes,
                               std::span<const host::ObjectWord> words) {
  AlgorithmTable table;
  std::string failure;
  for (const host::ObjectWord& word : words) {
    if (!word.slot()) {
      continue;
    }
    const canopen::Address address = canopen::object::slot_algorithm.address(*word.slot());
    for (const std::uint8_t node : nodes) {
      queue.read(node, address, [&, node, slot = *word.slot()](const host::SdoResult& result) {
        if (result.is_good()) {
          table.ids_[node].at(slot) = static_cast<std::uint8_t>(result.number());
        } else {
          failure = failure_text(node, "the algorithm in its slot", result.abort_code, bus.connection().diagnosis());
        }
      });
    }
  }
  finish(bus, queue);
  if (!failure.empty()) {
    throw std::runtime_error(failure);
  }
  return table;
}

std::int64_t raw_number(const canopen::Object& object, const host::SdoResult& result) {
  const std::uint32_t number = canopen::extend(object.type, result.number());
  return canopen::is_signed(object.type) ? std::int64_t{static_cast<std::int32_t>(number)} : std::int64_t{number};
}

}  // namespace proleg::tools
