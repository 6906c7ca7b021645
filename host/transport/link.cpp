#include "host/transport/link.hpp"

#include <unistd.h>

#include <array>
#include <cerrno>

namespace proleg::host {
namespace {

class DescriptorLink final : public Link {
 public:
  explicit DescriptorLink(int descriptor) : descriptor_(descriptor) {}

  [[nodiscard]] Opened open() override {
    if (!make_private(descriptor_)) {
      const int error = errno;
      static_cast<void>(descriptor_.release());
      throw TransportError(std::string(system_text(error)) + ": this process has not inherited such a descriptor");
    }
    return {std::move(descriptor_), false};
  }
  [[nodiscard]] std::string silence_hint() const override { return "is there an slcan adapter at its other end?"; }
  [[nodiscard]] bool can_reopen() const override { return false; }

 private:
  Descriptor descriptor_;
};

}  // namespace

std::string Link::connect_failure(int error) const { return system_text(error); }

std::string Link::end_text(int error) {
  return error == 0 || error == EPIPE || error == ECONNRESET
             ? "the other end has closed the connection"
             : std::string("the connection has ended: ") + system_text(error);
}

std::unique_ptr<Link> make_descriptor_link(int descriptor) { return std::make_unique<DescriptorLink>(descriptor); }

std::string program_folder() {
  std::array<char, 4'096> path{};
  const ssize_t length = readlink("/proc/self/exe", path.data(), path.size());
  const std::string program(path.data(), length > 0 ? static_cast<std::size_t>(length) : 0U);
  return program.substr(0, program.rfind('/') + 1);
}

}  // namespace proleg::host
