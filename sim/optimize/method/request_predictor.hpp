#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "sim/optimize/method/gait_problem.hpp"

namespace proleg::optimize {

/// Predicts what an algorithm of pagmo will ask for, so that workers can simulate ahead. (pagmo asks for one fitness
/// after the other.)
///
/// It rehearses the algorithm on copies. A copy receives the answers that the algorithm has received since the copy was
/// made, and then a very bad fitness for everything else. What the copy asks for then is what the algorithm will ask
/// for if nothing good turns up. Most algorithms do not use a fitness before the end of a generation, so the prediction
/// is right until there. Where it is wrong, the algorithm is rehearsed again. The algorithm itself sees no difference.
class RequestPredictor {
 public:
  /// Thrown through an algorithm that stagnates, when its candidates no longer differ.
  struct Stagnated {};

  /// hub: what the algorithm's problem asks; must outlive this, which answers it from now on. population: number of
  /// evaluations in a generation. stagnates: whether to end when all requests of a generation lie within half a step,
  /// or are the same candidate.
  RequestPredictor(GaitProblemHub& hub, std::uint32_t population, bool stagnates);

  /// Runs `perform`. rehearse: does the same on copies, any number of times, and changes nothing else.
  void run(const std::function<void()>& rehearse, const std::function<void()>& perform);

  [[nodiscard]] std::uint64_t asked() const { return asked_; }  ///< in all runs

 private:
  std::vector<double> answer(const std::vector<double>& x);
  std::vector<double> answer_rehearsal(const std::vector<double>& x);
  void predict(const Candidate& wanted);
  bool raise_needed_score();  ///< whether it did
  void check_stagnation(const std::vector<double>& x);
  [[nodiscard]] std::size_t remaining() const { return expected_.size() - next_; }

  GaitProblemHub& hub_;
  std::uint32_t population_;
  bool stagnates_;
  std::uint64_t asked_ = 0;
  std::optional<double> best_cost_;
  bool has_new_best_ = false;  ///< since the source last received the needed score

  const std::function<void()>* rehearse_ = nullptr;
  std::vector<std::vector<double>> answered_;  ///< in this run
  std::vector<Candidate> expected_;            ///< from next_ on: the predicted requests
  std::size_t next_ = 0;
  bool is_rehearsing_ = false;
  std::size_t repeated_ = 0;   ///< of answered_, in the rehearsal
  bool expected_all_ = false;  ///< whether expected_ reaches to the end of the run

  // The requests since the generation began.
  std::vector<double> min_;
  std::vector<double> max_;
  Candidate first_;
  bool all_equal_ = true;
  std::uint32_t checked_ = 0;
  std::uint32_t min_checked_ = 0;  ///< evaluations before a verdict
};

}  // namespace proleg::optimize
