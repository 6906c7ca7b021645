#include "tools/proleg/ui/session_router.hpp"

#include "tools/proleg/ui/recorded_session.hpp"
#include "tools/proleg/ui/remote_session.hpp"

namespace proleg::tools {

void SessionRouter::operate(const host::OperationRequest& request) {
  if (request.name.starts_with(RecordedSession::prefix)) {
    recordings_.operate(request);
  } else if (request.name.starts_with(RemoteSession::prefix)) {
    remote_.operate(request);
  } else {
    robot_.operate(request);
  }
}

void SessionRouter::stop(const host::StopRequest& request) {
  robot_.stop(request);
  remote_.stop(request);
}

void SessionRouter::holder_changed(bool has_holder, bool is_away) {
  robot_.holder_changed(has_holder, is_away);
  remote_.holder_changed(has_holder, is_away);
}

}  // namespace proleg::tools
