#pragma once

#include <boost/mpi/communicator.hpp>
#include <boost/mpi/environment.hpp>
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "sim/optimize/evaluation/message.hpp"
#include "sim/optimize/experiment/experiment.hpp"

namespace proleg::optimize {

/// Interval of polling MPI: waiting for MPI and for a local worker at once would use a whole core. A simulation takes
/// hundreds of times as long.
inline constexpr std::chrono::milliseconds poll_interval{1};

/// Kinds of messages between ranks, as MPI's tags.
enum class MpiTag : int {
  // Messages from rank 0.
  tasks = 1,
  stop,
  // Messages to rank 0.
  results,
  failure,  ///< text with the reason why a task failed
  message,  ///< text for the user
  stopped,  ///< the answer to stop
};

struct MpiMessage {
  int rank;  ///< rank that sent the message
  MpiTag tag;
  Bytes content;

  [[nodiscard]] std::string text() const;
};

/// Sends and receives bytes over MPI. The constructor initialises MPI, the destructor ends it.
class MpiChannel {
 public:
  MpiChannel() : environment_(false) {}

  [[nodiscard]] int size() const { return world_.size(); }
  [[nodiscard]] int rank() const { return world_.rank(); }

  void send(int rank, MpiTag tag, const Bytes& content = {}) const;
  void send(int rank, MpiTag tag, const std::string& text) const;
  /// Takes a message that has arrived; nothing if none has.
  [[nodiscard]] std::optional<MpiMessage> receive() const;

  /// Sends this rank's identity to all and returns all identities, by rank. All ranks must call it.
  [[nodiscard]] std::vector<std::string> exchange(const std::string& identity) const;

  [[noreturn]] void abort() const;

 private:
  boost::mpi::environment environment_;
  boost::mpi::communicator world_;
};

/// Text of experiment and build, on which all ranks must agree.
[[nodiscard]] std::string mpi_identity(const Experiment& experiment, const std::string& build_id);

}  // namespace proleg::optimize
