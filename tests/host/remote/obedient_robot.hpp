#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/remote/bound_elements.hpp"

namespace proleg::host {

/// A robot that writes down what it is told.
class ObedientRobot final : public RemoteTarget {
 public:
  void set(const std::vector<std::string>& words, std::uint64_t gesture) override {
    sets.push_back(words);
    gestures.push_back(gesture);
  }
  void command(RobotCommand command) override {
    constexpr const char* names[] = {"run", "pause", "step", "restart"};
    log += std::string(names[static_cast<std::size_t>(command)]) + ' ';
  }
  void stop(const std::string& by) override { log += "stop(" + by + ") "; }
  [[nodiscard]] std::optional<double> present(const std::string& parameter) const override {
    const auto found = values.find(parameter);
    return found == values.end() ? std::nullopt : std::optional(found->second);
  }
  [[nodiscard]] bool is_running() const override { return runs; }

  std::string log;
  std::vector<std::vector<std::string>> sets;
  std::vector<std::uint64_t> gestures;
  std::map<std::string, double> values;
  bool runs = false;
};

}  // namespace proleg::host
