#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "host/remote/binding.hpp"

namespace proleg::tools {

/// What names of parameters, as for --set, mean in the documents `robot` and `parameters` (docs/page-interface.md). So
/// they mean the same on every kind of robot.
class ParameterWords {
 public:
  struct Parameter {
    double minimum = 0;  ///< in its unit, as all of these
    double maximum = 0;
    bool has_limits = true;  ///< false: an angle that wraps
    double wanted = 0;       ///< of the first joint that the name means
    double resolution = 0;   ///< of the modules' number format
  };

  void set_robot(const nlohmann::json& document) { robot_ = document; }
  void set_parameters(const nlohmann::json& document) { parameters_ = document; }

  /// [MODULE.]NAME[:JOINT]. Throws InputError. where: begins its message.
  [[nodiscard]] Parameter find(const std::string& name, const std::string& where = {}) const;

 private:
  [[nodiscard]] bool is_module(const nlohmann::json& slot, const std::string& module) const;

  nlohmann::json robot_ = nlohmann::json::object();
  nlohmann::json parameters_ = nlohmann::json::array();
};

/// Throws InputError if the robot has no such parameters, or a limit is outside theirs. where: for the message.
void check_binding(const host::Binding& binding, const ParameterWords& words, const std::string& where);

}  // namespace proleg::tools
