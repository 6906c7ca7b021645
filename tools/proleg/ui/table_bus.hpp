#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "host/robot/bus_monitor.hpp"
#include "host/robot/sdo_queue.hpp"
#include "host/robot/shared_bus.hpp"
#include "host/server/robot_session.hpp"
#include "tools/proleg/robot/bus_access.hpp"
#include "tools/proleg/ui/bus_sharing.hpp"
#include "tools/proleg/ui/bus_view.hpp"

namespace proleg::tools {

/// A bus with modules on a table that this program has open without a robot that it drives: viewers see what is on it,
/// and jobs of other programs take part in it. It has a thread of its own.
class TableBus {
 public:
  /// Opens the bus, and publishes the document `bus`. sharing, output: must outlive this. Throws InputError for a bad
  /// address, host::TransportError if it cannot be reached.
  TableBus(std::string address, BusSharing& sharing, host::SessionOutput& output);
  ~TableBus();
  TableBus(const TableBus&) = delete;
  TableBus& operator=(const TableBus&) = delete;

  [[nodiscard]] const std::string& address() const { return address_; }
  /// The address and, as far as known, the adapter behind it.
  [[nodiscard]] const std::string& description() const { return description_; }
  /// Sends all modules the quick stop. Any thread may call it.
  void stop_modules() { stops_ = true; }

 private:
  void run();
  void serve();
  void send_stops();

  std::string address_;
  std::string description_;
  BusSharing& sharing_;
  host::SessionOutput& output_;
  BusAccess bus_;
  host::BusMonitor monitor_;
  host::BusAttachment monitor_attachment_;
  host::SdoQueue queue_;
  host::BusAttachment queue_attachment_;
  host::SharedBus shared_;
  BusViews views_;
  bool had_job_ = false;
  std::atomic<bool> stops_ = false;
  std::atomic<bool> ends_ = false;
  std::thread thread_;
};

}  // namespace proleg::tools
