#include "core/task_queue.hpp"

#include <utility>

#include "core/parallel.hpp"

namespace brisance {

TaskQueue::TaskQueue(std::size_t capacity) : capacity_(capacity), thread_([this] { work(); }) {}

TaskQueue::~TaskQueue() {
  {
    std::lock_guard const lock(mutex_);
    ending_ = true;
    while (tasks_.size() > 1) tasks_.pop_back();
  }
  changed_.notify_all();
  thread_.join();
}

void TaskQueue::add(std::function<void()> task) {
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return tasks_.size() < capacity_ || failure_; });
    throw_failure();
    tasks_.push_back(std::move(task));
  }
  changed_.notify_all();
}

void TaskQueue::check() {
  std::lock_guard const lock(mutex_);
  throw_failure();
}

void TaskQueue::finish() {
  settle();
  check();
}

void TaskQueue::settle() noexcept {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return tasks_.empty(); });
}

void TaskQueue::throw_failure() {
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void TaskQueue::work() {
  use_all_cores();
  FlushSubnormals const flush;
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ending_ || !tasks_.empty(); });
    if (tasks_.empty()) return;
    std::function<void()> const& task = tasks_.front();
    lock.unlock();
    std::exception_ptr failure;
    try {
      task();
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    if (failure) {
      failure_ = failure;
      tasks_.clear();
    } else {
      tasks_.pop_front();
    }
    changed_.notify_all();
  }
}

}  // namespace brisance
