#include "bridge/harness.hpp"
