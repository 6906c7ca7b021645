#include "tools/proleg/ui/served_page.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "tools/proleg/ui/telemetry_layout.hpp"

namespace proleg::tools {
namespace {

host::NoticeLevel level_of(NoticeLevel level) {
  switch (level) {
    case NoticeLevel::error:
      return host::NoticeLevel::error;
    case NoticeLevel::warning:
      return host::NoticeLevel::warning;
    case NoticeLevel::info:
      break;
  }
  return host::NoticeLevel::info;
}

}  // namespace

ServedPage::ServedPage(boost::asio::io_context& context, host::ServerOptions server, const sim::Scenario& scenario,
                       const sim::Losses* losses, SimulatedSessionOptions session)
    : server_(context, std::move(server), *this), session_(scenario, losses, std::move(session), *this) {}

void ServedPage::operate(const host::OperationRequest& request) {
  session_.operate(request.request, request.name, request.arguments);
}

void ServedPage::stop(const host::StopRequest& request) { session_.stop(request.request, request.by); }

void ServedPage::publish(const std::string& document, const nlohmann::json& value) { server_.publish(document, value); }

void ServedPage::set_signals(const std::vector<Signal>& signals, std::uint32_t tick_us) {
  server_.set_signals(layout_of(signals), tick_us);
}

void ServedPage::add_row(std::uint16_t run, std::uint32_t tick, std::span<const std::int32_t> row) {
  server_.add_row(run, tick, row);
}

void ServedPage::done(std::uint64_t request, const nlohmann::json& value) { server_.answer(request, value); }

void ServedPage::refused(std::uint64_t request, const std::string& why) { server_.refuse(request, why); }

void ServedPage::stopped(std::uint64_t request, unsigned confirmed, unsigned joints, double milliseconds) {
  server_.stopped(request, confirmed, joints, milliseconds);
}

void ServedPage::notice(NoticeLevel level, const std::string& text) { server_.notice(level_of(level), text); }

}  // namespace proleg::tools
