/// Wall-clock timing of phases.
#pragma once

#include <chrono>

namespace brisance {

/// Adds the seconds of its own life to a sum.
class PhaseTimer {
 public:
  explicit PhaseTimer(double& sum) : sum_(&sum) {}
  ~PhaseTimer() { *sum_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  PhaseTimer(PhaseTimer const&) = delete;
  PhaseTimer& operator=(PhaseTimer const&) = delete;

 private:
  double* sum_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace brisance
