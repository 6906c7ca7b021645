#include "tools/proleg/search/suspects.hpp"

#include <algorithm>
#include <exception>
#include <span>
#include <string_view>
#include <system_error>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/hash/sha256.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/adaptation/gait_rating.hpp"
#include "sim/scenario/damage.hpp"
#include "tools/proleg/common/build_id.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/terminal.hpp"

namespace proleg::tools {
namespace {

constexpr std::string_view no_suspects = "none";

/// Damages that are simulated before the scores are kept: a user who stops the command loses no more.
constexpr std::size_t damages_at_once = 8;

/// Those of an earlier command with the same inputs. What cannot be read is made again.
optimize::DamageScores kept_scores(const std::filesystem::path& file, const std::string& inputs, std::size_t gaits) {
  if (found_instead_of_file(file)) {  // also what cannot be read to an end, such as a pipe
    return {};
  }
  try {
    return optimize::read_damage_scores(read_whole_file(file), inputs, gaits);
  } catch (const FileError&) {
    return {};
  }
}

/// Adds scores to those of the file, which another command may have written meanwhile.
void keep_scores(const std::filesystem::path& file, const std::string& inputs, optimize::DamageScores scores,
                 std::size_t gaits) {
  std::error_code error;
  if (std::filesystem::exists(file, error) && !std::filesystem::is_regular_file(file, error)) {
    return;
  }
  try {
    scores.merge(kept_scores(file, inputs, gaits));
    write_file(file, optimize::text_of(scores, inputs));
  } catch (const std::exception&) {
    // An atlas that cannot be written to, or a full disk: the next time takes longer, and nothing else is lost.
  }
}

}  // namespace

std::vector<std::string> suspected_damages(const std::vector<std::string>& named, const optimize::Atlas& atlas) {
  const sim::Scenario& intact = atlas.experiment.scenario;
  std::vector<std::string> suspects;
  if (!atlas.experiment.on_robot && std::ranges::find(named, no_suspects) == named.end()) {
    suspects = sim::usual_damages(intact);
  }
  for (const std::string& word : named) {
    if (word == no_suspects) {
      continue;
    }
    if (atlas.experiment.on_robot) {
      throw InputError("--suspect", 0, in_quotes(word) + " and a map that a robot has filled",
                       "a map of a simulated robot, whose gaits can be simulated with this damage");
    }
    sim::Scenario damaged = intact;
    try {
      sim::apply_damage(damaged, {word});
    } catch (const InputError& refused) {
      throw InputError(std::string("--suspect: ") + refused.problem());
    }
    if (const std::string its = sim::damage_word(intact, word); std::ranges::find(suspects, its) == suspects.end()) {
      suspects.push_back(its);
    }
  }
  return suspects;
}

optimize::DamageScores scores_with(const optimize::Atlas& atlas, const std::filesystem::path& folder,
                                   const std::vector<std::string>& suspects) {
  const std::filesystem::path file =
      folder / ("damage_scores_" + number_text(atlas.experiment.scenario.duration_s) + "s.txt");
  const std::string inputs = sha256_hex(atlas.fingerprint() + ' ' + result_key);
  optimize::DamageScores scores = kept_scores(file, inputs, atlas.gaits.size());
  std::vector<std::string> missing;
  for (const std::string& suspect : suspects) {
    if (!scores.contains(suspect)) {
      missing.push_back(suspect);
    }
  }
  CountProgress progress("gaits simulated with suspected damages", atlas.gaits.size() * missing.size());
  for (std::size_t first = 0; first < missing.size(); first += damages_at_once) {
    const std::span<const std::string> damages =
        std::span(missing).subspan(first, std::min(damages_at_once, missing.size() - first));
    const auto show = [&](double share) {
      const double done = static_cast<double>(first) + share * static_cast<double>(damages.size());
      progress.show_share(done / static_cast<double>(missing.size()));
    };
    scores.merge(optimize::rate_with_damages(atlas, damages, show, [] { return interrupted(); }));
    keep_scores(file, inputs, scores, atlas.gaits.size());
  }
  return scores;
}

}  // namespace proleg::tools
