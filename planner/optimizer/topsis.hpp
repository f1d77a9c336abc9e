// SPDX-License-Identifier: BSD-3-Clause
// Modified TOPSIS: which solution of a front is flown. Deng, Yeh and Willis (2000), "Inter-company comparison using
// modified TOPSIS with objective weights".
#pragma once

#include <span>
#include <vector>

#include "planner/optimizer/pareto.hpp"

namespace jink::planner::optimizer {

/// Indices of `costs`, best compromise first. Objectives are minimised. Each column is shifted so that its smallest
/// value is 0 (differs: Deng et al. take positive data; [Paper] Eq. (3) is negative) and normalised to unit length;
/// distances to the ideal and the anti-ideal point of this unweighted matrix are Euclidean with weights inside the sum;
/// the highest closeness wins, ties by index.
///
/// `weights` has one value >= 0 for each objective; empty: weights from the entropy of the columns.
/// Where the costs differ in violation, a smaller violation comes first and only the feasible (or equally violating)
/// are compared. A constant column takes no part; where all are constant, or one solution is given, the order is by
/// index.
std::vector<int> topsis_order(std::span<const Cost> costs, int objectives, std::span<const double> weights = {});

/// Entropy weights of the columns, summing to 1; 0 for a constant column; equal where all are constant.
std::vector<double> entropy_weights(std::span<const Cost> costs, int objectives);

}  // namespace jink::planner::optimizer
