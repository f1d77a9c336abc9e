// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/study/selection.hpp"

#include <algorithm>
#include <stdexcept>

#include "tools/lab/algorithms/registry.hpp"

namespace jink::tools::lab::study {

Selection::Selection(const Results& results) : results_(results), sizes_(sizes_of(results.settings)) {
  for (const auto& [number, record] : results.runs) records_[record.job.variant].push_back(&record);
}

Records Selection::find(RunKind kind, std::string_view algorithm, std::string_view world, int sharing, int population,
                        int iterations) const {
  const Variant variant{
      kind, std::string(algorithm), std::string(world), has_slaves(algorithm) ? sharing : 0, population, iterations};
  const auto found = records_.find(variant);
  return found == records_.end() ? Records() : found->second;
}

Records Selection::paths(std::string_view algorithm, std::string_view world) const {
  return paths(algorithm, world, sizes_.sharing);
}

Records Selection::paths(std::string_view algorithm, std::string_view world, int sharing) const {
  return find(RunKind::kPath, algorithm, world, sharing, sizes_.population, sizes_.iterations);
}

Records Selection::paths(std::string_view algorithm, std::string_view world, int population, int iterations) const {
  return find(RunKind::kPath, algorithm, world, sizes_.sharing, population, iterations);
}

Records Selection::fronts(std::string_view algorithm, std::string_view world, int sharing) const {
  return find(RunKind::kFront, algorithm, world, sharing, sizes_.population, sizes_.iterations);
}

Records Selection::anytime(std::string_view algorithm, std::string_view world) const {
  return find(RunKind::kAnytime, algorithm, world, sizes_.sharing, sizes_.population, sizes_.iterations);
}

std::vector<double> values(const Records& records, const std::string& name) {
  std::vector<double> list;
  for (const Record* r : records) list.push_back(r->values.at(name));
  return list;
}

std::vector<double> measured(const Records& records, const std::string& name) {
  std::vector<double> list;
  for (const Record* r : records) list.push_back(r->measured.at(name));
  return list;
}

std::vector<double> scaled(std::vector<double> list, double factor) {
  for (double& value : list) value *= factor;
  return list;
}

Records reached(const Records& records) {
  Records result;
  for (const Record* r : records)
    if (r->value(key::kReached) > 0.0) result.push_back(r);
  return result;
}

std::vector<double> paired_differences(const Records& a, const Records& b,
                                       const std::function<double(const Record&)>& value,
                                       const std::function<bool(const Record&)>& counts) {
  std::vector<double> differences;
  for (const Record* x : a) {
    const auto y = std::find_if(b.begin(), b.end(), [&](const Record* r) { return r->job.run == x->job.run; });
    if (y != b.end() && counts(*x) && counts(**y)) differences.push_back(value(*x) - value(**y));
  }
  return differences;
}

std::string label_of(std::string_view algorithm) {
  const algorithms::Algorithm* const found = algorithms::find_algorithm(algorithm);
  return std::string(found == nullptr ? algorithm : found->label);
}

int place_of(std::string_view algorithm) {
  const auto all = algorithms::algorithms();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const algorithms::Algorithm& a) { return a.name == algorithm; });
  return static_cast<int>(found - all.begin());
}

std::string world_number(std::string_view world) {
  return std::string(world.substr(world.rfind('-') + 1));
}

}  // namespace jink::tools::lab::study
