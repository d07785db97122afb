#pragma once
/// \file A queue of ROS callbacks that are called one after the other.

#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>

#include <functional>

namespace cloth_sim {

/// Callbacks of subscribers, servers and timers, called by one thread of its own. Whatever would be
/// unsafe while one of them is under way can run in that thread, too.
class SerialQueue {
 public:
  SerialQueue() { spinner_.start(); }

  /// Returns a handle in the namespace of `parent` whose callbacks come here.
  ros::NodeHandle handle(const ros::NodeHandle& parent);
  /// Runs `work` between two callbacks and waits for it. Once ROS shuts down it is left undone. Not
  /// to be called by a callback.
  void run(const std::function<void()>& work);
  /// Waits for the callback under way; no other is called any more.
  void stop() { spinner_.stop(); }

 private:
  ros::CallbackQueue queue_;
  ros::AsyncSpinner spinner_{1, &queue_};
};

}  // namespace cloth_sim
