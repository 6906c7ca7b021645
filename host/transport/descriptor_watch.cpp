#include "host/transport/descriptor_watch.hpp"

#include <boost/asio/posix/stream_descriptor.hpp>

namespace proleg::host {

using boost::asio::posix::stream_descriptor;

/// The handlers own this, so that one that is under way when the watch has gone finds no function.
class DescriptorWatch::Events : public std::enable_shared_from_this<DescriptorWatch::Events> {
 public:
  Events(boost::asio::io_context& context, int descriptor, std::function<void()> function)
      : descriptor_(context.get_executor(), descriptor), function_(std::move(function)) {}

  void wait() {
    descriptor_.async_wait(stream_descriptor::wait_read,
                           [self = shared_from_this()](const boost::system::error_code& error) {
                             if (!error) {
                               self->call();
                             }
                           });
  }
  void stop() {
    is_stopped_ = true;
    static_cast<void>(descriptor_.release());
  }

 private:
  void call() {
    if (!is_stopped_) {
      function_();
    }
    if (!is_stopped_) {
      wait();
    }
  }

  stream_descriptor descriptor_;
  const std::function<void()> function_;
  bool is_stopped_ = false;
};

DescriptorWatch::DescriptorWatch(boost::asio::io_context& context, int descriptor, std::function<void()> function)
    : events_(std::make_shared<Events>(context, descriptor, std::move(function))) {
  events_->wait();
}

DescriptorWatch::~DescriptorWatch() { events_->stop(); }

}  // namespace proleg::host
