#pragma once
/// \file Service calls off the thread of the user interface.

#include <QObject>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace cloth_sim {

/// Carries out tasks one after the other in a thread of its own: a node that is slow to answer, or
/// gone, does not hold up rviz.
class ServiceQueue {
 public:
  using Task = std::function<void()>;

  ServiceQueue() : thread_([this] { run(); }) {}
  /// Waits for the task that is being carried out; the others are dropped.
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
  std::thread thread_;  // last: starts when everything above is there
};

/// Has `task` carried out in the thread of `receiver`, unless that is gone by then.
inline void runIn(QObject* receiver, std::function<void()> task) {
  QMetaObject::invokeMethod(receiver, std::move(task), Qt::QueuedConnection);
}

}  // namespace cloth_sim
