// SPDX-License-Identifier: BSD-3-Clause
// PMOMVO on a problem of the user's.
#include <nanobind/stl/string.h>

#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "config/settings.hpp"
#include "planner/optimizer/pmomvo.hpp"
#include "python/module/types.hpp"

namespace jink::python {
namespace {

using namespace planner::optimizer;
namespace base = planner::base;

using Numbers = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Rows = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using AnyRows = nb::ndarray<const double, nb::ndim<2>, nb::device::cpu>;
using AnyNumbers = nb::ndarray<const double, nb::ndim<1>, nb::device::cpu>;

std::span<const double> span_of(const Numbers& numbers) {
  return {numbers.data(), numbers.size()};
}

/// A problem whose costs a Python function computes, of many solutions at a time.
class UserProblem final : public Problem {
 public:
  /// The bounds and the function outlive it. `owner` keeps alive what the function is shown.
  UserProblem(std::span<const double> lower, std::span<const double> upper, int objectives, nb::handle function,
              nb::handle owner)
      : lower_(lower), upper_(upper), objectives_(objectives), function_(function), owner_(owner) {}

  [[nodiscard]] int dimension() const override { return static_cast<int>(lower_.size()); }
  [[nodiscard]] int objectives() const override { return objectives_; }
  [[nodiscard]] std::span<const double> lower() const override { return lower_; }
  [[nodiscard]] std::span<const double> upper() const override { return upper_; }

  /// Called by several slaves at once, which the interpreter lets in one after the other.
  void evaluate(std::span<const double> x, std::span<Cost> costs) const override {
    const nb::gil_scoped_acquire gil;
    const Table<const double> solutions(x.data(), {costs.size(), lower_.size()}, owner_);
    const nb::object result = function_(solutions);
    if (nb::isinstance<nb::tuple>(result) && nb::len(result) == 2) {
      take_objectives(result[0], costs);
      take_violations(result[1], costs);
    } else {
      take_objectives(result, costs);
      for (Cost& cost : costs) cost.violation = 0.0;
    }
  }

 private:
  void take_objectives(const nb::handle& given, std::span<Cost> costs) const {
    AnyRows f;
    const auto m = static_cast<std::size_t>(objectives_);
    if (!nb::try_cast(given, f) || f.shape(0) != costs.size() || f.shape(1) != m) {
      refuse("the objectives", given, std::to_string(costs.size()) + " x " + std::to_string(m));
    }
    for (std::size_t i = 0; i < costs.size(); ++i)
      for (std::size_t k = 0; k < m; ++k) costs[i].f[k] = f(i, k);
  }

  static void take_violations(const nb::handle& given, std::span<Cost> costs) {
    AnyNumbers violation;
    if (!nb::try_cast(given, violation) || violation.shape(0) != costs.size())
      refuse("the violations", given, std::to_string(costs.size()));
    for (std::size_t i = 0; i < costs.size(); ++i) costs[i].violation = violation(i);
  }

  /// Throws TypeError.
  [[noreturn]] static void refuse(const std::string& what, const nb::handle& given, const std::string& shape) {
    const std::string type = nb::cast<std::string>(nb::str(nb::object(nb::handle(given.type()).attr("__name__"))));
    const std::string has = nb::hasattr(given, "shape")
                                ? " of shape " + nb::cast<std::string>(nb::str(nb::object(given.attr("shape"))))
                                : "";
    throw nb::type_error((what + ": expected an array of " + shape + " numbers, not " + type + has).c_str());
  }

  std::span<const double> lower_, upper_;
  int objectives_;
  nb::handle function_, owner_;
};

struct Result {
  Front front;
  int objectives = 1;
  RunReport report;
};

int checked(const char* name, int value, int most) {
  if (value >= 1 && value <= most) return value;
  throw std::invalid_argument(std::string(name) + ": Value " + std::to_string(value) + " not in range 1 to " +
                              std::to_string(most));
}

/// An optimizer of the library, for problems of one shape.
struct Optimizer {
  static constexpr int kMostVariables = 100000;

  Optimizer(const config::Settings& parameters, int variables, int functions)
      : settings(parameters.optimizer),
        dimension(checked("dimension", variables, kMostVariables)),
        objectives(checked("objectives", functions, kMaxObjectives)),
        pmomvo(settings, dimension, objectives) {}

  base::OptimizerSettings settings;
  int dimension;
  int objectives;
  Pmomvo pmomvo;
  std::atomic<bool> working{false};
};

void check_bounds(const Optimizer& optimizer, const Numbers& lower, const Numbers& upper) {
  const auto d = static_cast<std::size_t>(optimizer.dimension);
  if (lower.size() != d || upper.size() != d)
    throw std::invalid_argument("lower, upper: expected " + std::to_string(d) + " numbers each, not " +
                                std::to_string(lower.size()) + " and " + std::to_string(upper.size()));
  for (std::size_t j = 0; j < d; ++j) {
    if (!std::isfinite(lower(j)) || !std::isfinite(upper(j)) || lower(j) > upper(j))
      throw std::invalid_argument("lower, upper: of variable " + std::to_string(j) + ": " + std::to_string(lower(j)) +
                                  " to " + std::to_string(upper(j)) + " is no range");
  }
}

Result run(Optimizer& optimizer, const nb::typed<nb::callable, nb::any(...)>& evaluate, const Numbers& lower,
           const Numbers& upper, const std::optional<Rows>& initial, std::uint64_t seed, std::uint64_t stream,
           std::optional<int> generations, std::optional<double> deadline_ms, int threads) {
  const AtWork at_work(optimizer.working);
  check_bounds(optimizer, lower, upper);
  std::span<const double> first;
  if (initial) {
    if (initial->shape(1) != static_cast<std::size_t>(optimizer.dimension))
      throw std::invalid_argument("initial: expected rows of " + std::to_string(optimizer.dimension) +
                                  " numbers, not " + std::to_string(initial->shape(1)));
    first = {initial->data(), initial->size()};
  }
  const UserProblem problem(span_of(lower), span_of(upper), optimizer.objectives, evaluate, nb::find(&optimizer));
  const base::Budget budget = budget_of(generations.value_or(optimizer.settings.iterations), deadline_ms);
  const nb::gil_scoped_release released;
  base::WorkerPool pool(threads);
  const Front& front = optimizer.pmomvo.run(problem, first, seed, stream, budget, pool);
  return {front, optimizer.objectives, optimizer.pmomvo.report()};
}

Table<const double> objectives_of(const Result& result) {
  const Cost* const costs = result.front.costs.data();
  return {costs == nullptr ? nullptr : costs->f.data(),
          {result.front.size(), static_cast<std::size_t>(result.objectives)},
          {},
          {static_cast<std::int64_t>(sizeof(Cost) / sizeof(double)), std::int64_t{1}}};
}

}  // namespace

void add_optimizer(nb::module_& module) {
  nb::class_<Result>(module, "Front", "n solutions of which none dominates another; what the run did.")
      .def("__len__", [](const Result& r) { return r.front.size(); })
      .def_prop_ro(
          "x",
          [](const Result& r) -> Table<const double> {
            return {r.front.x.data(), {r.front.size(), static_cast<std::size_t>(r.front.dimension)}};
          },
          "n x dimension: the decision variables")
      .def_prop_ro("f", &objectives_of, "n x objectives")
      .def_prop_ro(
          "violation",
          [](const Result& r) -> Column<const double> {
            const Cost* const costs = r.front.costs.data();
            return {costs == nullptr ? nullptr : &costs->violation,
                    {r.front.size()},
                    {},
                    {static_cast<std::int64_t>(sizeof(Cost) / sizeof(double))}};
          },
          "n: 0 where a solution is feasible")
      .def_prop_ro("evaluations", [](const Result& r) { return r.report.evaluations; })
      .def_prop_ro("generations", [](const Result& r) { return r.report.generations; })
      .def_prop_ro("deadline_reached", [](const Result& r) { return r.report.deadline_reached; });
  nb::class_<Optimizer>(module, "Pmomvo", "PMOMVO, for problems of one shape.")
      .def(nb::init<const config::Settings&, int, int>(), nb::arg("settings"), nb::arg("dimension"),
           nb::arg("objectives"))
      .def_ro("dimension", &Optimizer::dimension)
      .def_ro("objectives", &Optimizer::objectives)
      .def("run", &run, nb::arg("evaluate"), nb::arg("lower"), nb::arg("upper"), nb::kw_only(),
           nb::arg("initial").none() = nb::none(), nb::arg("seed") = 1, nb::arg("stream") = 0,
           nb::arg("generations").none() = nb::none(), nb::arg("deadline_ms").none() = nb::none(),
           nb::arg("threads") = 1);
}

}  // namespace jink::python
