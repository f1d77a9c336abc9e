// SPDX-License-Identifier: BSD-3-Clause
#include "planner/plan.hpp"

namespace jink::planner {

std::string_view to_string(PlanStatus status) {
  switch (status) {
    case PlanStatus::kReaches:
      return "reaches";
    case PlanStatus::kProgresses:
      return "progresses";
    case PlanStatus::kBlocked:
      return "blocked";
    case PlanStatus::kStartBlocked:
      return "start_blocked";
    case PlanStatus::kInvalid:
      return "invalid";
  }
  return "invalid";
}

}  // namespace jink::planner
