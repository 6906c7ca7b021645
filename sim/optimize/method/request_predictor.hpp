#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "sim/optimize/method/gait_problem.hpp"

namespace proleg::optimize {

/// Predicts the requests of an algorithm of pagmo, so that workers can simulate ahead. (pagmo requests one fitness
/// after the other.)
///
/// It rehearses the algorithm on copies. A copy receives the answers that the algorithm has received since the copy was
/// made, and then a very bad fitness for all other requests. These requests are those of the algorithm if no good
/// candidate is found. Most algorithms do not use a fitness before the end of a generation, so the prediction is right
/// until then. When it is wrong, the algorithm is rehearsed again. The algorithm itself does not see the rehearsals.
class RequestPredictor {
 public:
  /// Thrown through an algorithm that stagnates, when its candidates no longer differ.
  struct Stagnated {};

  /// hub receives the requests of the algorithm's problem; it must outlive the predictor, which answers them from now
  /// on. population: number of evaluations in a generation. stagnates: whether to end when all requests of a generation
  /// lie within half a step, or are the same candidate.
  RequestPredictor(GaitProblemHub& hub, std::uint32_t population, bool stagnates);

  /// Runs `perform`. rehearse: does the work of `perform` on copies, any number of times, and changes nothing else.
  void run(const std::function<void()>& rehearse, const std::function<void()>& perform);

  [[nodiscard]] std::uint64_t asked() const { return asked_; }  ///< number of requests in all runs

 private:
  std::vector<double> answer(const std::vector<double>& x);
  std::vector<double> answer_rehearsal(const std::vector<double>& x);
  void predict(const Candidate& wanted);
  bool raise_needed_score();  ///< returns whether it raised the score
  void check_stagnation(const std::vector<double>& x);
  [[nodiscard]] std::size_t remaining() const { return expected_.size() - next_; }

  GaitProblemHub& hub_;
  std::uint32_t population_;
  bool stagnates_;
  std::uint64_t asked_ = 0;
  std::optional<double> best_cost_;
  bool has_new_best_ = false;  ///< a new best since the source last received the needed score

  const std::function<void()>* rehearse_ = nullptr;
  std::vector<std::vector<double>> answered_;  ///< costs of the requests in this run
  std::vector<Candidate> expected_;            ///< the predicted requests, from next_ on
  std::size_t next_ = 0;
  bool is_rehearsing_ = false;
  std::size_t repeated_ = 0;   ///< number of answered_ that the rehearsal has repeated
  bool expected_all_ = false;  ///< whether expected_ reaches to the end of the run

  // Bounds of the requests since the generation began.
  std::vector<double> min_;
  std::vector<double> max_;
  Candidate first_;
  bool all_equal_ = true;
  std::uint32_t checked_ = 0;
  std::uint32_t min_checked_ = 0;  ///< evaluations before a verdict
};

}  // namespace proleg::optimize
