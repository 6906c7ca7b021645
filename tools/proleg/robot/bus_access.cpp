#include "tools/proleg/robot/bus_access.hpp"

#include <boost/asio/io_context.hpp>
#include <cstdlib>
#include <stdexcept>

#include "host/robot/host_presence.hpp"
#include "host/robot/object_word.hpp"
#include "host/transport/open_transport.hpp"
#include "tools/proleg/common/interrupt.hpp"
#include "tools/proleg/robot/bus_search.hpp"

namespace proleg::tools {

std::string BusOptions::address() const {
  const char* environment = std::getenv("PROLEG_BUS");
  return bus.value_or(environment != nullptr && *environment != '\0' ? environment : "auto");
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

void BusAccess::wait_for(const std::string& what, Microseconds at_most, const std::function<bool()>& done) {
  host::BusConnection& bus = connection();
  const bool is_done =
      bus.run_until(bus.now() + at_most, [&] { return done() || interrupted() || !bus.state().is_connected; });
  if (is_done && done()) {
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

}  // namespace proleg::tools
