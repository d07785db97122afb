#include "serial_queue.h"

#include <ros/init.h>

#include <boost/make_shared.hpp>
#include <chrono>
#include <future>

namespace cloth_sim {
namespace {

constexpr std::chrono::milliseconds kLookPeriod{50};

/// Work in a queue of callbacks.
class Work final : public ros::CallbackInterface {
 public:
  explicit Work(const std::function<void()>& work) : task_(work) {}
  std::future<void> done() { return task_.get_future(); }
  CallResult call() override {
    task_();
    return Success;
  }

 private:
  std::packaged_task<void()> task_;
};

}  // namespace

ros::NodeHandle SerialQueue::handle(const ros::NodeHandle& parent) {
  ros::NodeHandle node(parent);
  node.setCallbackQueue(&queue_);
  return node;
}

void SerialQueue::run(const std::function<void()>& work) {
  const auto callback = boost::make_shared<Work>(work);
  std::future<void> done = callback->done();
  queue_.addCallback(callback);
  while (done.wait_for(kLookPeriod) != std::future_status::ready) {
    if (ros::ok()) continue;
    stop();  // `work` is not to begin after this call
    return;
  }
  done.get();
}

}  // namespace cloth_sim
