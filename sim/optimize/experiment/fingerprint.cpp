#include <array>
#include <charconv>
#include <string_view>
#include <type_traits>

#include <sodium/crypto_hash_sha256.h>

#include "sim/optimize/experiment/experiment.hpp"

namespace proleg::optimize {
namespace {

/// A text that two experiments share if and only if they are the same: every item with a mark where it ends.
class CanonicalText {
 public:
  void add(std::string_view text) {
    text_ += std::to_string(text.size());
    text_ += ':';
    text_ += text;
  }
  void add(double number) {
    std::array<char, 40> buffer;
    const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number);
    add(std::string_view(buffer.data(), static_cast<std::size_t>(end - buffer.data())));
  }
  template <typename Whole>
  requires std::is_integral_v<Whole>
  void add(Whole number) {
    text_ += std::to_string(number);
    text_ += ';';
  }
  template <typename Enumeration>
  requires std::is_enum_v<Enumeration>
  void add(Enumeration value) { add(static_cast<int>(value)); }
  void add(const std::optional<double>& number) {
    add(number.has_value());
    add(number.value_or(0.0));
  }
  template <typename... Items>
  void add_all(const Items&... items) {
    (add(items), ...);
  }

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

struct MethodWriter {
  CanonicalText* text;

  void operator()(const GreatDelugeSettings& deluge) const {
    text->add_all(deluge.water_level, deluge.rain, deluge.credits, deluge.retries, deluge.confidence, deluge.step,
                  deluge.growth, deluge.move, deluge.neighbour, deluge.start, deluge.first_must_pass,
                  deluge.reevaluations, deluge.chains, deluge.target);
  }
  void operator()(const GeneticSettings& genetic) const {
    text->add_all(genetic.population, genetic.mutation, genetic.crossover, genetic.generations_to_convergence,
                  genetic.convergence, genetic.mode);
  }
  void operator()(const PagmoSettings& pagmo) const {
    text->add_all(pagmo.population, pagmo.generations, pagmo.sigma0, pagmo.crossover, pagmo.scale, pagmo.mutation);
  }
};

void add_setting(CanonicalText& text, const sim::Setting& setting) {
  text.add_all(setting.slot, setting.joint, setting.index, setting.internal, setting.value);
}

void add_space(CanonicalText& text, const SearchSpace& space) {
  text.add(space.dimensions.size());
  for (const Dimension& dimension : space.dimensions) {
    text.add_all(std::string_view(dimension.name), dimension.unit, dimension.targets.size(), dimension.values.size());
    for (const sim::Setting& target : dimension.targets) {
      add_setting(text, target);
    }
    for (const std::int32_t value : dimension.values) {
      text.add(value);
    }
  }
}

void add_objectives(CanonicalText& text, const std::vector<Objective>& objectives) {
  text.add(objectives.size());
  for (const Objective& objective : objectives) {
    text.add_all(std::string_view(objective.name), objective.goal, objective.failed, objective.terms.size());
    for (const Term& term : objective.terms) {
      text.add_all(declaration_of(term.measure).name, term.weight);
    }
  }
}

/// The files as they are, and what may differ from them by the command line.
void add_scenario(CanonicalText& text, const sim::Scenario& scenario) {
  text.add(scenario.sources.size());
  for (const sim::SourceFile& source : scenario.sources) {
    text.add(std::string_view(source.text));
  }
  text.add_all(scenario.duration_s, scenario.step_s, scenario.solver, scenario.contact_noise,
               scenario.kernel.tick_period_us, scenario.kernel.seed, scenario.settings.size(), scenario.changes.size());
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
  text.add(std::string_view(method_name(method)));
  std::visit(MethodWriter{&text}, method);
  add_space(text, space);
  add_objectives(text, objectives);
  text.add_all(heading_deg, trials.count, trials.aggregate, trials.spread.friction, trials.spread.mass,
               trials.spread.servo_gain, trials.spread.latency_ms, trials.spread.contact_noise, racing.after,
               racing.keep, reuse, seed);
  add_scenario(text, scenario);

  std::array<unsigned char, crypto_hash_sha256_BYTES> digest;
  // The result is not looked at: it is 0 always.
  crypto_hash_sha256(digest.data(), reinterpret_cast<const unsigned char*>(text.text().data()), text.text().size());
  constexpr std::string_view digits = "0123456789abcdef";
  std::string hexadecimal;
  for (const unsigned char byte : digest) {
    hexadecimal += digits[byte >> 4U];
    hexadecimal += digits[byte & 15U];
  }
  return hexadecimal;
}

}  // namespace proleg::optimize
