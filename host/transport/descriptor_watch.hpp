#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>
#include <memory>

namespace proleg::host {

/// Calls a function, from the io_context, as long as a descriptor can be read. The function may destroy the watch.
class DescriptorWatch {
 public:
  /// The descriptor stays open longer than the watch; its owner closes it.
  DescriptorWatch(boost::asio::io_context& context, int descriptor, std::function<void()> function);
  ~DescriptorWatch();
  DescriptorWatch(const DescriptorWatch&) = delete;
  DescriptorWatch& operator=(const DescriptorWatch&) = delete;

 private:
  class Events;
  std::shared_ptr<Events> events_;
};

}  // namespace proleg::host
