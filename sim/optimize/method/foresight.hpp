#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "sim/optimize/method/gait_problem.hpp"

namespace proleg::optimize {

/// Finds out what an algorithm of pagmo, which asks for one fitness after the other, will ask for, and tells the
/// source.
///
/// The algorithm is rehearsed on copies: what it has been told since the copies were made it is told again, everything
/// after that is answered with a very bad fitness, and what it asks for then is what it will ask for if nothing good
/// turns up. Most algorithms do not look at a fitness before the end of a generation, so that nothing of it is wrong.
/// Where it is wrong, the algorithm is rehearsed once more. The algorithm itself cannot tell the difference.
class Foresight {
 public:
  /// Thrown through the algorithm when its candidates do not differ any more (settles).
  struct Settled {};

  /// hub: what the algorithm's problem asks; must outlive this, and is answered by it from now on. population: so many
  /// evaluations are a generation. settles: whether it is the end when all that is asked for in a generation lies
  /// within half a step, or is the same candidate.
  Foresight(GaitProblemHub& hub, std::uint32_t population, bool settles);

  /// Runs `perform`. rehearse: does the same on copies, as often as wanted, and leaves no trace.
  void run(const std::function<void()>& rehearse, const std::function<void()>& perform);

  [[nodiscard]] std::uint64_t asked() const { return asked_; }  ///< in all runs

 private:
  std::vector<double> answer(const std::vector<double>& x);
  std::vector<double> answer_rehearsal(const std::vector<double>& x);
  void foresee(const Candidate& wanted);
  bool raise_needed_score();  ///< true if it did
  void watch(const std::vector<double>& x);
  [[nodiscard]] std::size_t remaining() const { return expected_.size() - next_; }

  GaitProblemHub& hub_;
  std::uint32_t population_;
  bool settles_;
  std::uint64_t asked_ = 0;
  std::optional<double> best_cost_;
  bool better_ = false;  ///< since the source was told the score that matters

  const std::function<void()>* rehearse_ = nullptr;
  std::vector<std::vector<double>> answered_;  ///< in this run
  std::vector<Candidate> expected_;            ///< from next_ on: what will be asked for
  std::size_t next_ = 0;
  bool rehearsing_ = false;
  std::size_t repeated_ = 0;   ///< of answered_, in the rehearsal
  bool expected_all_ = false;  ///< whether it is all that the run will ask for

  // What was asked for since the generation began.
  std::vector<double> lowest_;
  std::vector<double> highest_;
  Candidate first_;
  bool alike_ = true;
  std::uint32_t watched_ = 0;
  std::uint32_t watch_ = 0;  ///< evaluations to be watched at least
};

}  // namespace proleg::optimize
