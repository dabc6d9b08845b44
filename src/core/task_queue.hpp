/// A thread that works off tasks one after another while the calculation goes on.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace brisance {

/// Tasks are carried out in the order in which they were added. When one throws, those behind it are dropped, and the
/// next `add`, `check` or `finish` throws its exception.
class TaskQueue {
 public:
  /// At most `capacity` tasks are waiting or under way.
  explicit TaskQueue(std::size_t capacity);
  /// Drops the tasks that wait, and waits for the one that is under way.
  ~TaskQueue();
  TaskQueue(TaskQueue const&) = delete;
  TaskQueue& operator=(TaskQueue const&) = delete;

  /// Waits for room first.
  void add(std::function<void()> task);
  /// Throws what a task threw.
  void check();
  /// Waits until all tasks are done.
  void finish();
  /// Waits until no task is left, and throws nothing.
  void settle() noexcept;

 private:
  void work();
  void throw_failure();

  std::size_t capacity_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> tasks_;  ///< the first one is under way
  std::exception_ptr failure_;
  bool ending_ = false;
  std::thread thread_;  ///< the last member: it begins when all others stand
};

}  // namespace brisance
