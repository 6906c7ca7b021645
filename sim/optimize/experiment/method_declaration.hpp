#pragma once

// The methods of searches and their settings, declared once: the reader of experiment files and the page take names,
// ranges, defaults and meaning from here.

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace proleg::optimize {

struct Experiment;

/// Numbers of objectives that a method can handle.
enum class ObjectiveCount : std::uint8_t { one, several, any };

/// An algorithm of pagmo, as the section <pagmo> names it; three of them have sections of their own.
struct PagmoDeclaration {
  std::string_view name;  ///< pagmo's name
  ObjectiveCount objectives;
  std::uint32_t min_population;       ///< below it pagmo throws or crashes
  std::uint32_t population_multiple;  ///< the population must be a multiple of this
  std::string_view title;
  std::string_view help;
};

/// All algorithms, sorted by name.
[[nodiscard]] std::span<const PagmoDeclaration> pagmo_declarations();

/// A setting of a method: a tag in <properties>.
struct MethodSetting {
  enum class Kind : std::uint8_t { whole, number, choice };

  std::string_view tag;
  Kind kind;
  double lowest = 0.0;  ///< of a number, bounds included
  double highest = 0.0;
  std::vector<std::string_view> choices = {};  ///< the words of a choice
  std::string usual = {};                      ///< what holds without the tag; empty: the method decides
  std::string_view help = {};
};

/// A method: the outermost tag of an experiment file, and of <pagmo> its algorithm.
struct MethodDeclaration {
  std::string_view tag;
  std::string_view algorithm;  ///< empty unless the tag is "pagmo"
  std::string_view title;
  std::string_view help;
  ObjectiveCount objectives;
  bool has_map;  ///< whether it needs the axes of a map (Experiment::axes)
  std::vector<MethodSetting> settings;
};

/// The tags of the method sections: an experiment file has one as its outermost tag.
inline constexpr std::array<std::string_view, 7> method_tags{
    "geneticAlgorithm", "greatDeluge", "cmaEs", "differentialEvolution", "nsga2", "pagmo", "mapElites"};

/// All methods: those with sections of their own, then the others of pagmo.
[[nodiscard]] const std::vector<MethodDeclaration>& methods();

/// Throws InputError if the method cannot search this experiment: unknown, the wrong number of objectives, or settings
/// that do not fit.
void check_method(const Experiment& experiment);

}  // namespace proleg::optimize
