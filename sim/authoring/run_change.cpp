#include "sim/authoring/run_change.hpp"

#include <array>
#include <cstddef>
#include <optional>

#include "sim/authoring/scenario_text.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {
namespace {

constexpr std::array<std::string_view, 3> solvers{"automatic", "direct", "iterative"};
constexpr std::string_view properties_tag = "simulationProperties";

}  // namespace

std::string_view word_of(Solver solver) { return solvers.at(static_cast<std::size_t>(solver)); }

std::optional<Solver> solver_named(std::string_view word) {
  for (std::size_t i = 0; i < solvers.size(); ++i) {
    if (solvers[i] == word) {
      return static_cast<Solver>(i);
    }
  }
  return std::nullopt;
}

void RunChange::set_property(std::string_view tag, const std::string& content) {
  const std::string file = name_of(scenario_.path);
  if (!change_.xml(file).child(0, properties_tag)) {
    change_.apply(file, change_.xml(file).add_last(
                            0, "<" + std::string(properties_tag) + ">\n</" + std::string(properties_tag) + ">"));
  }
  set_tag(change_, file, change_.xml(file).child(0, properties_tag).value(), tag, content);
}

ElementNumber RunChange::physics() {
  const std::string& file = scenario_.environment_file;
  if (!change_.xml(file).child(0, "physicsengine")) {
    const std::string engine(name_of(scenario_.environment.engine));
    change_.apply(file, change_.xml(file).add_first(0, "<physicsengine type=\"" + engine + "\">\n</physicsengine>"));
  }
  return change_.xml(file).child(0, "physicsengine").value();
}

void RunChange::set_physics(std::string_view tag, const std::string& content) {
  const std::string& file = scenario_.environment_file;
  const ElementNumber engine = physics();
  if (change_.xml(file).children(engine).empty()) {
    const std::string name = std::string(name_of(scenario_.environment.engine)) + "properties";
    change_.apply(file, change_.xml(file).add_last(engine, "<" + name + ">\n</" + name + ">"));
  }
  // All engines read the properties of each other (docs/scenario-files.md).
  set_tag(change_, file, change_.xml(file).children(engine).front(), tag, content);
}

void RunChange::set_duration(double seconds) { set_property("duration", number_text_of(seconds)); }

void RunChange::set_seed(std::uint64_t seed) { set_property("seed", std::to_string(seed)); }

void RunChange::set_tick(double milliseconds) { set_property("tick", number_text_of(milliseconds)); }

void RunChange::set_step(double milliseconds) { set_property("stepWidth", number_text_of(milliseconds / 1e3)); }

void RunChange::set_solver(Solver solver) { set_property("solver", std::string(word_of(solver))); }

void RunChange::set_contact_noise(double probability) { set_property("contactNoise", number_text_of(probability)); }

void RunChange::set_engine(PhysicsEngine engine) {
  const ElementNumber element = physics();
  const XmlText& xml = change_.xml(scenario_.environment_file);
  change_.apply(scenario_.environment_file, xml.set_attribute(element, "type", name_of(engine)));
}

void RunChange::set_gravity(const Eigen::Vector3d& metres_per_s2) {
  set_physics("gravity", vector_text(metres_per_s2));
}

void RunChange::set_self_collision(bool is_on) { set_physics("selfcollision", is_on ? "1" : "0"); }

}  // namespace proleg::sim
