// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/study/record.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <stdexcept>

#include "tools/lab/study/worlds.hpp"

namespace jink::tools::lab::study {
namespace {

using Json = nlohmann::ordered_json;

RunKind kind_from(const std::string& text) {
  for (const RunKind kind : {RunKind::kFront, RunKind::kPath, RunKind::kAnytime})
    if (to_string(kind) == text) return kind;
  throw std::runtime_error(fmt::format("'{}' is no kind of run", text));
}

std::map<std::string, double> numbers_from(const Json& object, const char* name) {
  std::map<std::string, double> result;
  for (const auto& [key, value] : object.at(name).items()) {
    if (!value.is_number()) throw std::runtime_error(fmt::format("{}.{} is no number", name, key));
    result.emplace(key, value.get<double>());
  }
  return result;
}

/// What must be there for the tables.
void check(const Record& r) {
  const auto require = [](const auto& map, std::initializer_list<const char*> names) {
    for (const char* name : names)
      if (map.find(name) == map.end()) throw std::runtime_error(fmt::format("the run has no {}", name));
  };
  const auto same_length = [&](const char* a, const char* b) {
    if (r.series.at(a).size() != r.series.at(b).size())
      throw std::runtime_error(fmt::format("{} and {} differ in length", a, b));
  };
  require(r.values, {key::kEvaluations});
  require(r.measured, {key::kThreads});
  switch (r.job.variant.kind) {
    case RunKind::kFront:
      require(r.values, {key::kHv, key::kMs, key::kHrs, key::kSize});
      require(r.series, {key::kF1, key::kF2});
      same_length(key::kF1, key::kF2);
      break;
    case RunKind::kPath:
      require(r.values, {key::kReached, key::kLength, key::kSlr, key::kFlight, key::kClearance});
      require(r.measured, {key::kPlanning});
      if (!is_pictured(r.job.variant.world)) break;
      require(r.series, {key::kT, key::kX, key::kY, key::kZ});
      for (const char* axis : {key::kX, key::kY, key::kZ}) same_length(key::kT, axis);
      break;
    case RunKind::kAnytime:
      require(r.series, {key::kEvaluationsAt, key::kHvAt});
      same_length(key::kEvaluationsAt, key::kHvAt);
      for (std::size_t i = 0; i < r.series.at(key::kHvAt).size(); ++i)
        require(r.measured, {key::seconds_at(i).c_str()});
      break;
  }
}

}  // namespace

std::string key::seconds_at(std::size_t i) {
  return fmt::format("seconds_at_{}", i);
}

Json to_json(const Record& r) {
  Json line{{"type", "run"},
            {"job", r.job.number},
            {"kind", to_string(r.job.variant.kind)},
            {"algorithm", r.job.variant.algorithm},
            {"world", r.job.variant.world},
            {"sharing", r.job.variant.sharing},
            {"population", r.job.variant.population},
            {"iterations", r.job.variant.iterations},
            {"run", r.job.run},
            {"seed", r.job.seed}};
  line["values"] = r.values;
  line["series"] = r.series;
  line["measured"] = r.measured;
  return line;
}

Record record_from(const Json& line) {
  Record r;
  try {
    line.at("job").get_to(r.job.number);
    r.job.variant.kind = kind_from(line.at("kind").get<std::string>());
    line.at("algorithm").get_to(r.job.variant.algorithm);
    line.at("world").get_to(r.job.variant.world);
    line.at("sharing").get_to(r.job.variant.sharing);
    line.at("population").get_to(r.job.variant.population);
    line.at("iterations").get_to(r.job.variant.iterations);
    line.at("run").get_to(r.job.run);
    line.at("seed").get_to(r.job.seed);
    r.values = numbers_from(line, "values");
    r.measured = numbers_from(line, "measured");
    for (const auto& [name, list] : line.at("series").items()) r.series.emplace(name, list.get<std::vector<double>>());
  } catch (const Json::exception& error) {
    throw std::runtime_error(std::string("the run: ") + error.what());
  }
  check(r);
  return r;
}

bool same_result(const Record& a, const Record& b) {
  return a.job.number == b.job.number && a.job.variant == b.job.variant && a.job.run == b.job.run &&
         a.job.seed == b.job.seed && a.values == b.values && a.series == b.series;
}

}  // namespace jink::tools::lab::study
