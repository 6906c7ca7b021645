#include <string_view>
#include <type_traits>

#include "shared/computer/hash/sha256.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/experiment/experiment.hpp"
#include "sim/optimize/experiment/experiment_parts.hpp"

namespace proleg::optimize {
namespace {

/// A text that is equal for two experiments only if the experiments are equal: each item has a mark at its end.
class CanonicalText {
 public:
  void add(std::string_view text) {
    text_ += std::to_string(text.size());
    text_ += ':';
    text_ += text;
  }
  void add(double number) { add(std::string_view(exact_text(number))); }
  template <typename Whole>
  requires std::is_integral_v<Whole>
  void add(Whole number) {
    text_ += std::to_string(number);
    text_ += ';';
  }
  void add(sim::Solver solver) { add(static_cast<int>(solver)); }
  void add(sim::PhysicsEngine engine) { add(static_cast<int>(engine)); }
  template <typename... Items>
  void add_all(const Items&... items) {
    (add(items), ...);
  }

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

void add_setting(CanonicalText& text, const sim::Setting& setting) {
  text.add_all(setting.slot, setting.joint, setting.index, setting.internal, setting.value);
}

/// Adds the texts of the files, and the settings that the command line may change.
void add_scenario(CanonicalText& text, const sim::Scenario& scenario) {
  text.add(scenario.sources.size());
  for (const sim::SourceFile& source : scenario.sources) {
    text.add(std::string_view(source.text));
  }
  text.add_all(scenario.duration_s, scenario.step_s, scenario.environment.engine, scenario.solver,
               scenario.contact_noise, scenario.kernel.tick_period_us, scenario.kernel.seed, scenario.settings.size(),
               scenario.changes.size());
  for (const Slot& slot : scenario.kernel.slots) {
    if (slot.algorithm != nullptr && slot.algorithm->declaration().sources != 0) {
      text.add(slot.algorithm->declaration().sources);
    }
  }
  for (const sim::Setting& setting : scenario.settings) {
    add_setting(text, setting);
  }
  for (const sim::Change& change : scenario.changes) {
    text.add_all(change.tick, change.settings.size());
    for (const sim::Setting& setting : change.settings) {
      add_setting(text, setting);
    }
  }
}

}  // namespace

std::string Experiment::fingerprint() const {
  CanonicalText text;
  for (const ExperimentPart& part : parts_of(*this)) {
    text.add(std::string_view(part.text));
  }
  add_scenario(text, scenario);
  return sha256_hex(text.text());
}

}  // namespace proleg::optimize
