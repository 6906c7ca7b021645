#include "tools/proleg/ui/table_bus.hpp"

#include <exception>
#include <nlohmann/json.hpp>
#include <utility>

#include "shared/canopen/declared_objects.hpp"
#include "shared/canopen/power_state.hpp"

namespace proleg::tools {

TableBus::TableBus(std::string address, BusSharing& sharing, host::SessionOutput& output)
    : address_(std::move(address)),
      sharing_(sharing),
      output_(output),
      bus_(BusOptions{address_}),
      monitor_(bus_.connection()),
      monitor_attachment_(bus_.connection(), monitor_),
      queue_(bus_.connection()),
      queue_attachment_(bus_.connection(), queue_),
      shared_(bus_.context(), bus_.connection()),
      views_(address_, bus_.connection(), monitor_) {
  description_ = bus_.connection().description();
  monitor_.set_reads_touch(true);
  thread_ = std::thread([this] { run(); });
}

TableBus::~TableBus() {
  ends_ = true;
  thread_.join();
}

void TableBus::run() {
  while (!ends_) {
    try {
      serve();
    } catch (const std::exception& error) {
      output_.notice(host::NoticeLevel::error, address_ + ": " + error.what());
      std::this_thread::sleep_for(BusViews::period);
    }
  }
}

void TableBus::serve() {
  constexpr Microseconds look_period_us = 5'000;
  for (host::Descriptor& end : sharing_.take_programs()) {
    shared_.add(std::move(end));
  }
  shared_.look_at_connection(sharing_.longest_loss());
  // Two programs that ask one module at a time get each other's answers.
  const bool has_job = sharing_.has_job();
  if (had_job_ && !has_job) {
    monitor_.forget_silent(bus_.connection().now());
  }
  had_job_ = has_job;
  monitor_.set_reads(!has_job);
  if (stops_.exchange(false)) {
    send_stops();
  }
  if (const std::optional<BusView> view = views_.due(BusViews::Clock::now())) {
    nlohmann::json document = bus_document({}, *view);
    if (has_job) {  // the program of the job may give servos power meanwhile
      for (nlohmann::json& module : document["modules"]) {
        module["drive"] = "not read";
      }
    }
    output_.publish("bus", document);
  }
  host::BusConnection& bus = bus_.connection();
  bus.run_until(bus.now() + look_period_us, [this] { return ends_ || stops_; });
}

void TableBus::send_stops() {
  for (const host::MonitoredNode& node : monitor_.nodes()) {
    queue_.write(node.node, canopen::object::controlword.address, canopen::object::controlword.type,
                 canopen::quick_stop_controlword, [](const host::SdoResult& /*result*/) {});
  }
}

}  // namespace proleg::tools
