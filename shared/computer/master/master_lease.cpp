#include <algorithm>

#include "shared/canopen/objects.hpp"
#include "shared/computer/master/master.hpp"

// The lease of the robot: exactly one of two hosts gets it (docs/protocol.md, The lease).

namespace proleg::canopen {

/// Number of attempts to take the lease of a module. A missing module takes the time of this number of answers.
constexpr unsigned lease_attempts = 2;

std::optional<SdoRequest> Master::lease_request(std::size_t position) const {
  const Object& token = object::session_token;
  switch (position + (only_reads_lease_ ? 1U : 0U)) {
    case 0:
      return SdoRequest{token.address, size_of(token.type), options_.session_token};
    case 1:
      // The answer to a write may belong to the write of another host, which has the same identifier.
      return SdoRequest{token.address};
    default:
      return std::nullopt;
  }
}

void Master::begin_lease() {
  if (options_.session_token == 0) {
    enter(Phase::reset);
    return;
  }
  lease_node_ = 0;
  lease_ends_ = now_ + lease_timeout_us - listening_time_us;
  take_next_lease();
}

/// Takes the leases in ascending order of the node ids. So at most one of two hosts is refused by a module whose lease
/// the other has.
void Master::take_next_lease() {
  const unsigned attempts = has_missing_lease_ ? 1 : lease_attempts;
  sdo_clients_.set_attempts(std::min(options_.attempts, attempts));
  while (lease_node_ < max_node_id) {
    if (joint_of_[++lease_node_] != no_joint) {
      only_reads_lease_ = false;
      enter(Phase::take_lease);
      return;
    }
  }
  sdo_clients_.set_attempts(options_.attempts);
  only_reads_lease_ = false;
  heartbeat_at_ = std::min(heartbeat_at_, now_);
  enter(Phase::reset);
}

/// Handles the token that the module has. Always returns false: the list ends.
bool Master::on_lease(unsigned joint, std::uint32_t holder) {
  if (holder != options_.session_token) {
    refuse_lease(joint);
  } else if (phase_ == Phase::take_lease && !has_lease_) {
    has_lease_ = true;
    heartbeat_at_ = now_;  // this host keeps the lease
  }
  return false;
}

void Master::on_lease_abort(unsigned joint, Address address, AbortCode code) {
  if (code == AbortCode::no_such_object) {
    return;  // the program of the module is older
  }
  if (code == AbortCode::refused_by_state && phase_ == Phase::take_lease && now_ < lease_ends_) {
    // The answer may be the one to another host's request: the lease may be this host's. The value decides.
    is_lease_refused_ = true;
    only_reads_lease_ = true;
    deadline_ = now_;
  } else if (code == AbortCode::refused_by_state) {
    refuse_lease(joint);
  } else if (phase_ == Phase::take_lease) {
    has_missing_lease_ = true;  // if the module is missing, that will be found after the reset
  } else {
    Problem problem = problem_of(code == AbortCode::timeout ? ProblemCode::no_answer : ProblemCode::refused, joint);
    problem.address = address;
    problem.abort_code = code;
    static_cast<void>(joint_failed(problem));
  }
}

/// Handles a lease that the module has given to another host. That host may have stopped: then its lease ends soon.
void Master::refuse_lease(unsigned joint) {
  if (phase_ == Phase::keep_lease) {
    static_cast<void>(joint_failed(problem_of(ProblemCode::lease_refused, joint)));
  } else if (now_ < lease_ends_) {
    is_lease_refused_ = true;
    only_reads_lease_ = false;
    deadline_ = now_ + lease_pause_us;
  } else {
    fail_without_lease(joint);
  }
}

void Master::fail_without_lease(unsigned joint) {
  fail(problem_of(ProblemCode::lease_refused, joint));
  heartbeat_at_ = never;
}

}  // namespace proleg::canopen
