#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

#include "core/task_queue.hpp"

namespace brisance::test {
namespace {

TEST(TaskQueue, CarriesOutTasksInTheirOrder) {
  std::vector<int> done;
  TaskQueue queue(3);
  for (int n = 0; n < 100; ++n) queue.add([&done, n] { done.push_back(n); });
  queue.finish();
  ASSERT_EQ(done.size(), 100U);
  for (int n = 0; n < 100; ++n) EXPECT_EQ(done[n], n);
}

TEST(TaskQueue, HoldsNoMoreTasksThanItsCapacity) {
  std::atomic<int> under_way = 0;
  std::atomic<int> most = 0;
  TaskQueue queue(2);
  for (int n = 0; n < 50; ++n) {
    queue.add([&under_way] { --under_way; });
    int const now = ++under_way;
    if (now > most) most = now;
  }
  queue.finish();
  EXPECT_EQ(under_way, 0);
  EXPECT_LE(most, 2);
}

TEST(TaskQueue, FailureDropsTheTasksBehindAndIsThrownOnce) {
  bool reached = false;
  TaskQueue queue(3);
  std::atomic<bool> go = false;
  queue.add([&go] {
    go.wait(false);
    throw std::runtime_error("disk full");
  });
  queue.add([&reached] { reached = true; });
  go = true;
  go.notify_all();
  queue.settle();
  try {
    queue.check();
    FAIL() << "the failure went unnoticed";
  } catch (std::runtime_error const& error) {
    EXPECT_STREQ(error.what(), "disk full");
  }
  EXPECT_FALSE(reached);
  queue.check();
  queue.add([&reached] { reached = true; });
  queue.finish();
  EXPECT_TRUE(reached);
}

TEST(TaskQueue, EndWaitsForTheTaskUnderWay) {
  std::atomic<bool> begun = false;
  bool ended = false;
  {
    TaskQueue queue(1);
    queue.add([&] {
      begun = true;
      begun.notify_all();
      ended = true;
    });
    begun.wait(false);
  }
  EXPECT_TRUE(ended);
}

}  // namespace
}  // namespace brisance::test
