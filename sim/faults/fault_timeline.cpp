// SPDX-License-Identifier: BSD-3-Clause
#include "sim/faults/fault_timeline.hpp"

#include <algorithm>
#include <utility>

namespace jink::sim::faults {
namespace {

using config::Fault;
using config::FaultKind;

/// Sums of steps differ from the file's times by rounding; a fault does not begin a step late for that.
constexpr double kTolerance = 1e-9;

/// The probability that one of two independent things happens.
double either(double a, double b) {
  return 1.0 - (1.0 - a) * (1.0 - b);
}

void add(const Fault& fault, Impairment& impairment) {
  switch (fault.kind) {
    case FaultKind::kLinkLoss:
      impairment.loss = 1.0;
      break;
    case FaultKind::kPacketLoss:
      impairment.loss = either(impairment.loss, fault.rate);
      break;
    case FaultKind::kDelay:
      impairment.delay += fault.seconds;
      break;
    case FaultKind::kReorder:
      impairment.reorder = either(impairment.reorder, fault.rate);
      break;
    default:
      break;
  }
}

}  // namespace

FaultTimeline::FaultTimeline(std::vector<config::Fault> faults)
    : faults_(std::move(faults)), active_(faults_.size(), false) {
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    changes_.push_back({i, true, faults_[i].at});
    if (faults_[i].duration) changes_.push_back({i, false, faults_[i].at + *faults_[i].duration});
  }
  std::stable_sort(changes_.begin(), changes_.end(), [](const FaultChange& a, const FaultChange& b) {
    return a.t != b.t ? a.t < b.t : !a.begins && b.begins;
  });
}

std::vector<FaultChange> FaultTimeline::advance(double t) {
  std::vector<FaultChange> now;
  for (; next_ < changes_.size() && changes_[next_].t <= t + kTolerance; ++next_) {
    const FaultChange& change = changes_[next_];
    if (!faults_[change.index].instantaneous()) active_[change.index] = change.begins;
    now.push_back(change);
  }
  return now;
}

std::string FaultTimeline::describe(const FaultChange& change) const {
  const Fault& fault = faults_[change.index];
  if (fault.instantaneous()) return fault.text();
  return fault.text() + (change.begins ? " begins" : " ends");
}

bool FaultTimeline::active(FaultKind kind) const {
  return !of_kind(kind).empty();
}

bool FaultTimeline::active(FaultKind kind, int vehicle) const {
  return find(kind, vehicle) != nullptr;
}

const Fault* FaultTimeline::find(FaultKind kind, int vehicle) const {
  const Fault* found = nullptr;
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    if (active_[i] && faults_[i].kind == kind && faults_[i].befalls(vehicle)) found = &faults_[i];
  }
  return found;
}

std::vector<const Fault*> FaultTimeline::of_kind(FaultKind kind) const {
  std::vector<const Fault*> found;
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    if (active_[i] && faults_[i].kind == kind) found.push_back(&faults_[i]);
  }
  return found;
}

LinkImpairment FaultTimeline::link(int vehicle) const {
  LinkImpairment link;
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    if (!active_[i] || !faults_[i].befalls(vehicle)) continue;
    if (faults_[i].direction != config::LinkDirection::kDown) add(faults_[i], link.up);
    if (faults_[i].direction != config::LinkDirection::kUp) add(faults_[i], link.down);
  }
  return link;
}

}  // namespace jink::sim::faults
