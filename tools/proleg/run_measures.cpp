#include "tools/proleg/run_measures.hpp"

#include <cmath>
#include <cstdio>

#include "shared/computer/text/text.hpp"

namespace proleg::tools {

Json measures_object(const sim::MeasureValues& values) {
  Json object = Json::empty_object();
  for (const sim::MeasureDeclaration& declaration : sim::measures()) {
    object.add(declaration.name, values[declaration.measure]);
  }
  return object;
}

void print_measures(const sim::MeasureValues& values) {
  std::printf("measures (docs/gait-measures.md)\n");
  for (const sim::MeasureDeclaration& declaration : sim::measures()) {
    if (const double value = values[declaration.measure]; std::isfinite(value)) {
      const std::string unit(declaration.unit);
      std::printf("  %-28s  %.4g%s\n", std::string(declaration.name).c_str(), value,
                  unit.empty() ? "" : (' ' + unit).c_str());
    }
  }
}

void append_results(const RunMeasures& measures, const sim::RobotModel& robot,
                    std::vector<std::pair<std::string, std::string>>& results) {
  for (const sim::MeasureDeclaration& declaration : sim::measures()) {
    if (std::isfinite(measures.values[declaration.measure])) {
      results.emplace_back(declaration.name, exact_text(measures.values[declaration.measure]));
    }
  }
  for (std::size_t link = 0; link < robot.links.size(); ++link) {
    results.emplace_back("duty_factor." + robot.links[link].name, exact_text(measures.link_duty_factors[link]));
  }
}

}  // namespace proleg::tools
