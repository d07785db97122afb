#pragma once
/// \file Service calls outside of the thread of the user interface.

#include <QObject>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace cloth_sim {

/// Runs tasks one after the other in a thread of its own, so that a node that is slow to answer,
/// or gone, does not block rviz.
class ServiceQueue {
 public:
  using Task = std::function<void()>;

  ServiceQueue() : thread_([this] { run(); }) {}
  /// Waits for the running task; drops the others.
  ~ServiceQueue();
  ServiceQueue(const ServiceQueue&) = delete;
  ServiceQueue& operator=(const ServiceQueue&) = delete;

  void post(Task task);

 private:
  void run();

  std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<Task> tasks_;
  bool stopping_ = false;
  std::thread thread_;  // last: it uses everything above
};

/// Runs `task` in the thread of `receiver`; drops it if the receiver is gone by then.
inline void runIn(QObject* receiver, std::function<void()> task) {
  QMetaObject::invokeMethod(receiver, std::move(task), Qt::QueuedConnection);
}

}  // namespace cloth_sim
