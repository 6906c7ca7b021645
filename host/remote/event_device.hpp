#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "host/remote/element.hpp"
#include "host/transport/descriptor.hpp"

struct libevdev;

namespace proleg::host {

/// One event device of the kernel, /dev/input/eventN.
class EventDevice {
 public:
  /// Throws std::system_error if the device cannot be opened.
  explicit EventDevice(const std::filesystem::path& path);

  [[nodiscard]] int descriptor() const { return descriptor_.number(); }
  [[nodiscard]] const std::vector<Element>& elements() const { return elements_; }
  [[nodiscard]] std::vector<double> positions() const;

  /// Calls the function for each movement that has come, and does not wait. If the kernel has dropped events, what they
  /// changed is found again. False: the device has gone.
  [[nodiscard]] bool read(const std::function<void(std::size_t element, double position)>& moved);

 private:
  using Code = std::pair<unsigned, unsigned>;  ///< type and code of an event

  void add_elements(unsigned type, unsigned codes, ElementKind kind);
  [[nodiscard]] double position(const Code& code, int value) const;

  Descriptor descriptor_;
  std::unique_ptr<libevdev, void (*)(libevdev*)> device_;
  std::vector<Element> elements_;
  std::vector<Code> codes_;  ///< of the elements
  std::map<Code, std::size_t> places_;
};

}  // namespace proleg::host
