#include "host/transport/descriptor.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cstring>

namespace proleg::host {

void Descriptor::close() {
  if (is_open()) {
    ::close(release());
  }
}

bool make_private(const Descriptor& descriptor) {
  const int flags = fcntl(descriptor.number(), F_GETFL);
  return flags >= 0 && fcntl(descriptor.number(), F_SETFL, flags | O_NONBLOCK) == 0 &&
         fcntl(descriptor.number(), F_SETFD, FD_CLOEXEC) == 0;
}

const char* system_text(int error) {
  const char* const text = strerrordesc_np(error);
  return text != nullptr ? text : "unknown error";
}

}  // namespace proleg::host
